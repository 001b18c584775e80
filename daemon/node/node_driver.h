#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/line_faults.h"
#include "core/network_controller.h"
#include "core/time.h"
#include "io/input.h"
#include "io/link_counters.h"
#include "io/node_clock.h"

namespace limb_ring::runtime {

/// Breaks the line out of a node on purpose, and mends it. (ours)
class LineBreaker {
 public:
  virtual ~LineBreaker() = default;

  /// As in fault::LineFaults; in effect when they return. Cutting or mending the line may change the node's state.
  virtual fault::LineFaults::Id begin(const fault::Fault& fault, core::Time now) = 0;
  virtual bool remove(fault::LineFaults::Id id, core::Time now) = 0;
  virtual void clear(core::Time now) = 0;
  virtual std::vector<fault::LineFaults::Listed> list(core::Time now) = 0;
  virtual const fault::LineCounters& counters() const = 0;
  /// Nothing more to wait for: the output is connected, or another fault keeps it from that.
  virtual bool mended() const = 0;
};

/// What happened to a node's link.
struct LinkChange {
  enum class Is : std::uint8_t { up, lost, refused };
  core::Line line;
  bool input;  ///< else output
  Is is;
  std::optional<std::uint8_t> other = {};  ///< the node at the other end; none if it was lost, or nobody knows
  std::string why = {};

  std::string words() const;  ///< "second line: input from node 3"
};

/// What comes out of the network controller. Handlers may call into the controller.
struct DriverListener {
  virtual ~DriverListener() = default;
  virtual void on_event(const core::Event& event) = 0;
  /// After all else of a round: packets may wait for the CPU.
  virtual void on_round_end() = 0;
  virtual void on_link(const LinkChange& change) = 0;
};

/// Sees what enters and leaves the node's controller, and changes nothing. In a folded ring it sees each packet once,
/// on whichever line it comes; packets that are only passed back on the second line are not shown.
struct LineTap {
  using Time = event_loop::NodeClock::Time;

  virtual ~LineTap() = default;
  virtual void on_input(const wire::Slice& slice, wire::NodeId from, Time at) = 0;
  virtual void on_output(wire::ByteView framed_slices, wire::NodeId to, Time at) = 0;
  /// Something is missing there, or the line has ended.
  virtual void on_input_gap(Time at) = 0;
  virtual void on_output_gap(Time at) = 0;
};

/// The nodes at the far ends of a node's two links of one line; nothing: the link is down.
struct LineEnds {
  std::optional<std::uint8_t> from, to;
};

/// Nodes that cannot connect with this one on a line, because one of the two refuses; null: there are none.
struct LineRefusals {
  const link::Refusals* by_input = nullptr;
  const link::Refusals* of_output = nullptr;
};

/// What drives the network controller of a node, as all that is built upon it sees it: links and the machine's clock,
/// or a virtual ring.
class NodeDriver {
 public:
  virtual ~NodeDriver() = default;

  virtual core::NetworkController& controller() = 0;
  virtual const core::NetworkController& controller() const = 0;
  /// @name What the node's CPU does to the controller
  ///@{
  virtual bool take(core::ReceivedPacket& packet) { return controller().take(now(), packet); }
  virtual void set_cpu_present(bool present) { controller().set_cpu_present(present); }
  virtual void cpu_reset(core::Owner owner) { controller().apply(core::input::CpuReset{owner}, now()); }
  ///@}
  virtual event_loop::NodeClock& clock() = 0;
  /// The controller's time. It stands still while a batch, and all that follows from it, is handled.
  virtual core::Time now() const = 0;
  /// Which line was lost last, and why; for people. Empty: none.
  virtual std::string last_loss() const { return ""; }
  /// When this driver was made, on the same clock.
  virtual core::Time started() const { return core::Time{}; }
  /// `when` on clock(), rounded up so that a timer never fires early.
  virtual event_loop::NodeClock::Time steady(core::Time when) const = 0;

  /// To be called after anything was asked of the controller. Calling it from within a handler
  /// only makes another round follow.
  virtual void pump() = 0;
  /// Calls pump() once at the end of the event loop's turn, however often it is asked for in that turn. For calls that
  /// come with every packet.
  virtual void pump_soon() = 0;
  /// Makes the call between two pump(), all in one instant: what was asked for before has begun by then, and has not
  /// ended, however long this process has to wait meanwhile. Not to be called from within a handler.
  virtual void pump_around(const std::function<void(core::Time now)>& call) {
    pump();
    call(now());
    pump();
  }
  virtual void close() = 0;
  /// The links' listening sockets are where they were made.
  virtual bool is_in_place() const = 0;
  /// Makes the links' listening sockets again, after the runtime folder was removed. @throw std::runtime_error
  virtual void listen_again() = 0;
  /// From now on `tap`, which may be null, sees the lines; it must outlive that.
  virtual void set_tap(LineTap* tap) = 0;

  /// From now on `journal`, which may be null, sees all that goes into the controller and comes out; it must outlive
  /// that.
  virtual void set_journal(core::Journal* journal) { controller().set_journal(journal); }

  /// @name Its lines. @pre has_second_line(), for the second
  ///@{
  bool has_second_line() const { return controller().settings().fold_back; }
  virtual LineEnds ends(core::Line line) const = 0;
  virtual const link::InputCounters& input_counters(core::Line line) const = 0;
  virtual const link::OutputCounters& output_counters(core::Line line) const = 0;
  /// Who was refused at the line's input, and who has refused its output. A virtual ring refuses nobody.
  virtual LineRefusals refusals(core::Line) const { return {}; }
  virtual LineBreaker& breaker(core::Line line) = 0;
  virtual const LineBreaker& breaker(core::Line line) const = 0;
  ///@}
  /// When the first line's input was last lost. If it fell silent instead: when it was last heard.
  virtual core::Time input_lost_at() const = 0;
  /// When this node learned of a broken line.
  virtual core::Time broken_since() const = 0;
};

/// The clock of the daemon: CLOCK_MONOTONIC, counted from its start, as the core
/// wants it. A steady time is rounded up, so that a timer never fires before its deadline.
class Clock {
 public:
  using Steady = std::chrono::steady_clock;

  /// @param start of the time of the core, not after now
  explicit Clock(Steady::time_point start = Steady::now()) : start_(start) {}

  core::Time now() const { return at(Steady::now()); }
  core::Time at(Steady::time_point when) const { return core::Time{} + (when - start_); }
  /// The last instant a steady clock knows (292 years), if `when` is later or kNever.
  Steady::time_point steady(core::Time when) const {
    const core::Duration since = when.time_since_epoch();
    if (since >= Steady::time_point::max() - start_) return Steady::time_point::max();
    return start_ + core::whole_nanoseconds(since) + std::chrono::nanoseconds(1);
  }

 private:
  Steady::time_point start_;
};

/// What clients may ask of a ring's virtual clock. Nothing here changes what happens on the ring, or at which instant
/// of its time.
class ClockControl {
 public:
  using nanoseconds = std::chrono::nanoseconds;
  struct State {
    nanoseconds now{0};
    double pace = 1;      ///< the ring's time per real time; infinite: as fast as the machine and the programs are
    nanoseconds late{0};  ///< behind real time at that pace
    nanoseconds lost{0};  ///< real time that the machine was too slow for, and that is not made up for
    bool paused = false;
    bool follows = false;       ///< it goes on no further than allow() has said
    nanoseconds allowed{0};     ///< if it follows
    nanoseconds outer_zero{0};  ///< if it follows: what the outer clock shows at 0 of the ring's
  };

  virtual ~ClockControl() = default;
  virtual State state() const = 0;
  virtual void set_pace(double factor) = 0;
  virtual void pause() = 0;
  /// Goes on after a pause.
  virtual void run() = 0;
  /// Pauses after another `time`. `done` is called once: when the clock has paused, or another request has replaced
  /// this one.
  virtual void step(nanoseconds time, std::function<void()> done) = 0;
  /// The outer clock has reached `until`, in ns of the ring's time. @return false if this ring follows no outer clock
  /// @param outer_zero what the outer clock shows at 0 of the ring's
  virtual bool allow(nanoseconds until, nanoseconds outer_zero) = 0;
  /// Time has gone on although `whom` should have been waited for, so the run is not repeatable.
  virtual void went_on_without(const std::string& whom) = 0;
};

}  // namespace limb_ring::runtime
