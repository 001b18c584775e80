#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "core/network_controller.h"
#include "judge/promise_judge.h"

namespace limb_ring::sim {

/// Recordings that cannot be read, or are not of this program's core: says which, and why.
struct UnreadableRecording : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// How a recorded ring is judged: as `ringctl record check` does it.
struct RecordedJudging {
  promises::JudgeTimes times{};
  core::Duration goes_on = std::chrono::milliseconds(50);           ///< see promises::NodeObserver
  std::chrono::nanoseconds round = std::chrono::milliseconds(100);  ///< see promises::PromiseJudge
};

/// One thing that was done to a recorded core, with a copy of all bytes. Times are of the machine's clock.
struct CoreCall {
  struct Begins {};  ///< a life begins
  struct Ends {};    ///< its process has ended
  struct Write {     ///< what was given out goes onto that line
    core::Line line;
  };
  struct TakeEvent {};
  struct TakePacket {};

  core::Time at{};
  std::size_t life = 0;
  std::variant<core::Input, Begins, Ends, Write, TakeEvent, TakePacket> what;
};

/// The input that a call is; null if it is something else.
template <class What>
const What* input_of(const CoreCall& call) {
  const auto* input = std::get_if<core::Input>(&call.what);
  return input == nullptr ? nullptr : std::get_if<What>(input);
}

/// An end of a line, as its node was told of it.
struct LineEnd {
  bool up = false;
  bool known = false;     ///< it was told
  wire::NodeId other{0};  ///< who is at the other end, now or last
};
/// The ends of the lines at a node, by core::Line.
struct LineEnds {
  std::array<LineEnd, 2> in, out;
  /// Applies a change of a line. @return false if it is something else
  bool see(const core::Input& input);
  /// Up, and with whom, are the same.
  bool is_as(const LineEnds& other) const;
  LineEnd& at(core::Line line, bool is_input) { return (is_input ? in : out)[static_cast<std::size_t>(line)]; }
  /// Calls visit(end, line, is_input) for each.
  template <class Visit>
  void each(const Visit& visit) {
    for (const core::Line line : {core::Line::first, core::Line::second})
      for (const bool is_input : {true, false}) visit(at(line, is_input), line, is_input);
  }
};

/// What look_of() says of a slice.
using Look = std::vector<std::uint8_t>;

/// A slice that has left a node, and what became of it.
struct Departure {
  std::size_t call = 0;  ///< the Write
  core::Line line{};
  wire::Slice slice;
  std::optional<wire::NodeId> to;  ///< nobody: its line was down, or that node is not recorded
  Look look;
  std::size_t nth = 0;                 ///< of that look on that line in the window, from 0
  std::optional<std::size_t> arrival;  ///< the call with which it came in
  bool lost = false;                   ///< it has not come in, or changed or late; else it may be under way
};

/// What a slice is known by when the same story is told a little differently: source, receiver, size, priority and try
/// of its packet, as far as they are in it. The sequence number is not: it is another one if an earlier send is left
/// out.
Look look_of(wire::NodeId from, core::Line line, const wire::Slice& slice);

/// What the flight recorders have saved of a ring in a span of time: the state of each core at its begin, and all that
/// was done to it from there on. (ours)
struct RecordedWindow {
  struct Life {
    wire::NodeId node{0};
    std::string name;
    core::Settings settings;
    core::Duration zero{0};           ///< the machine's time at 0 of the core's
    bool began = false;               ///< before the window, or at its first call
    bool over = false;                ///< before the window
    std::vector<std::uint8_t> state;  ///< of its core then
    LineEnds ends;                    ///< then
  };
  /// What the judge was told before the window.
  struct Told {
    enum class Kind { begins, sees, ends, leaves } kind = Kind::sees;
    std::int64_t at_ns = 0;
    std::uint8_t node = 0;
    std::uint8_t state = 0;                    ///< of a life that begins
    std::chrono::nanoseconds longest_send{0};  ///< its
    promises::Observation seen{};
  };

  std::chrono::nanoseconds recorded_from{0};  ///< the first record of all
  core::Time begin{}, end{};
  std::vector<Life> lives;
  std::vector<Told> told;
  std::vector<CoreCall> calls;                  ///< in the order of time
  std::vector<Departure> departures;            ///< in the order of `calls`
  std::deque<std::vector<std::uint8_t>> bytes;  ///< that the calls and departures show
  /// A span in which something stood still.
  struct Pause {
    std::size_t life;
    core::Time from, until;
  };
  std::vector<Pause> pauses;           ///< of cores: something was due for longer than patience()
  std::vector<Pause> unread;           ///< of CPUs: packets waited for longer than until a refused one goes again
  std::vector<std::size_t> under_way;  ///< arrivals of what had left before the window, or a node that is not recorded
  std::vector<std::size_t> unsent;     ///< arrivals of what nobody has sent so
  /// How long a slice takes from node to node: the median; and over any line.
  std::map<std::pair<wire::NodeId, wire::NodeId>, core::Duration> transits;
  core::Duration transit{0};

  /// The longest that is no fault of its own: half of the time-out of a try.
  core::Duration patience() const { return lives.front().settings.send_timeout() / 2; }
  core::Duration transit_of(wire::NodeId from, wire::NodeId to) const {
    const auto known = transits.find({from, to});
    return known == transits.end() ? transit : known->second;
  }
};

/// Replays what was saved in a folder and keeps what lies in that span.
/// @pre all of it is replayed exactly (Replay::difference())
/// @param from,until ns of the machine's clock
/// @throw std::runtime_error if it cannot be read
RecordedWindow read_window(const std::string& folder, std::chrono::nanoseconds from, std::chrono::nanoseconds until,
                           const RecordedJudging& judging);

}  // namespace limb_ring::sim
