#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "io/input.h"
#include "io/link_counters.h"
#include "io/link_header.h"
#include "io/node_clock.h"
#include "wire/slice.h"

namespace limb_ring::link {

/// One connection to a candidate for our downstream neighbour, from the first attempt on. Calls
/// its owner from the event loop only, never from within a call, and not after close().
class Downstream {
 public:
  /// Headers of the other end that are read in a row, before others get their turn; a node sends a few in a second.
  static constexpr int kMostHeaders = 64;
  /// Bytes that may wait for the socket. Far above what one batch brings: the Packet Manager writes only while nothing
  /// waits.
  static constexpr std::size_t kMostWaiting = 1 << 20;

  /// `candidate` is its index in OutputSettings::candidates.
  struct Owner {
    virtual void on_accepted(std::size_t candidate) = 0;
    virtual void on_refused(std::size_t candidate, const LinkHeader& refuse) = 0;
    /// As on_refused, but the sender has not proved who it is: for people only, nothing else follows from it.
    virtual void on_hint(std::size_t candidate, const LinkHeader& refuse) = 0;
    virtual void on_no_node(std::size_t candidate) = 0;  ///< what is there answers, but is not a node of the ring
    virtual void on_ended(std::size_t candidate, std::string_view reason) = 0;
    virtual void on_heard(std::size_t candidate) = 0;    ///< it says that it is alive
    virtual void on_drained(std::size_t candidate) = 0;  ///< nothing waits inside any more

   protected:
    ~Owner() = default;
  };

  virtual ~Downstream() = default;
  /// @return false: nobody is there; no call follows.
  virtual bool start() = 0;
  /// Whole framed slices. What the socket does not take waits inside, up to a limit, beyond
  /// which the line counts as ended.
  virtual void write(wire::ByteView slices) = 0;
  /// A slice to be sent after the next one, with its own sequence number: it arrives late.
  /// @return false: not possible on this line, or not now; nothing was taken.
  virtual bool hold_back(wire::ByteView) { return false; }
  virtual bool drained() const = 0;
  /// Says that this end lives, though it has nothing to send.
  virtual void say_idle() {
    wire::SliceWriter idle;
    idle.put(wire::SliceKind::idle, {});
    write(idle.view());
  }
  /// Once per `idle`: looks for signs of life of the other end, which alone do not wake this end.
  virtual void tick() = 0;
  /// Called now and then until accepted: asks again if questions can get lost.
  virtual void ask_again() = 0;
  virtual void close() = 0;
  /// As close(), but without telling the other end: as when the wire breaks.
  virtual void sever() { close(); }
};

/// Chooses whom our output goes to: the nearest living node in ring order (bypass, protocol.md
/// section 6.9; the rules are ours). No IO: told what happened, it says whom to try next.
///
/// Candidates are numbered in ring order, 0 being the configured successor and the last one
/// ourselves. A candidate is skipped when nobody is there, or when it leaves an attempt
/// unanswered for `silence`. One that is busy is alive, and nobody beyond a living node is tried:
/// then our line is cut, and the ring is an open chain.
class Successor {
 public:
  Successor(std::size_t candidates, const Timing& timing, Time now);

  /// The next one to be tried now; it counts as being tried from here on.
  std::optional<std::size_t> next(Time now);

  void absent(std::size_t candidate, Time now);  ///< nobody there, or no node of this ring
  void busy(std::size_t candidate, Time now);    ///< alive, with a nearer upstream than us
  /// It says so itself. All nodes between us and it are not there, so nobody is nearer to it than we are: if it says so
  /// for kBelieved it is passed over as if it were not there. @return false: it is not believed any more
  bool says_busy(std::size_t candidate, Time now);
  static constexpr std::chrono::seconds kBelieved{10};  ///< longer than a node takes to start
  /// Is in use from here on. @pre it is nearer than the one that was
  void accepted(std::size_t candidate, Time now);
  enum class Loss { ended, silent, replaced };
  void lost(Loss loss, Time now);  ///< the one in use

  std::optional<std::size_t> current() const { return current_; }

 private:
  struct Candidate {
    enum class State { untried, trying, absent, busy } state = State::untried;
    Time since{};                      ///< trying: since when; else: not again before
    bool missing = false;              ///< was not there when last tried: passed over while tried again
    std::optional<Time> busy_since{};  ///< it says so, and nothing else since
  };

  std::size_t farthest(Time now) const;
  bool passed_over(const Candidate& candidate, Time now) const;
  void set(std::size_t candidate, Candidate::State state, Time since, bool missing = false);

  Timing timing_;
  std::vector<Candidate> candidates_;
  std::optional<std::size_t> current_;
  std::optional<Time> patience_;  ///< at start: the configured successor only, until then
  Time up_since_{};
};

/// What an Output reports. Calls come from the event loop, never from inside a call into the
/// Output. A handler may close() the Output; nothing is called after that.
struct OutputHandler {
  virtual ~OutputHandler() = default;
  virtual void on_output_up(std::uint8_t to) = 0;
  /// It is gone, or a nearer one has come back (an on_output_up follows at once).
  virtual void on_output_lost(std::string_view reason) = 0;
  /// Node `by` will not be our downstream neighbour, or what is there is no node of this ring; once for each reason
  /// until an output comes up. `reason` is for people.
  virtual void on_output_refused(std::uint8_t by, std::string_view reason) = 0;
  /// Something had to wait inside, and has gone out: ready() is true again.
  virtual void on_output_ready() = 0;
};

/// A node our output may go to, and where it listens.
struct Candidate {
  std::uint8_t id = 0;
  Endpoint endpoint;
};

/// Where an Output may connect, in which order, and its times.
struct OutputSettings {
  Identity self;
  std::vector<Candidate> candidates;  ///< ring order: the configured successor first, we last
  Timing timing;
};

/// What has become of the wire behind an Output (ours: faults on purpose).
enum class Wire : std::uint8_t {
  whole,
  held,  ///< nothing passes for now, not even idles; what is connected stays so
  cut    ///< broken: what was connected is lost, the other end is not told
};

/// The sending end of the link OUT of a node: connected to the nearest living node in ring order
/// (bypass). While it bypasses somebody, it goes on asking those, and goes back to the first
/// that answers. A neighbour that says nothing for `silence` is dead or frozen, and lost.
/// One thread, one io_context. Not to be destroyed from within a call of its handler.
class Output final : private Downstream::Owner {
 public:
  /// @throw std::invalid_argument without candidates; std::runtime_error if a candidate's UDP address
  ///        is not numeric
  Output(boost::asio::io_context& io, const OutputSettings& settings, OutputHandler& handler);
  ~Output() { close(); }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  /// @param framed_slices whole slices. All are taken: what the socket does not take waits
  ///        inside, what is given while down() or after a failure is discarded and counted.
  void write(wire::ByteView framed_slices);
  /// One slice that is to arrive late: over UDP its datagram keeps its sequence number and is sent behind the next one.
  /// On other lines, and where something waits inside, it is lost, which is what lateness is to the receiver.
  void write_late(wire::ByteView framed_slice);
  /// Connected, and nothing waits inside.
  bool ready() const { return current_ && current_->drained(); }
  bool up() const { return current_ != nullptr; }
  /// @pre up()
  std::uint8_t to() const { return settings_.candidates[*successor_.current()].id; }

  /// While the wire is not whole no node is asked to connect, and none is bypassed: the wire is broken, not the node
  /// behind it. Cutting it calls the handler's on_output_lost.
  void set_wire(Wire wire);

  /// Hangs up. No call of the handler afterwards.
  void close();
  const OutputCounters& counters() const { return counters_; }
  /// Nodes that have refused us for a reason that asking again does not mend.
  const Refusals& refusals() const { return refusals_; }

 private:
  struct Attempt {
    std::shared_ptr<Downstream> line;
    Time since;
  };

  void on_accepted(std::size_t candidate) override;
  void on_refused(std::size_t candidate, const LinkHeader& refuse) override;
  void on_hint(std::size_t candidate, const LinkHeader& refuse) override;
  void on_no_node(std::size_t candidate) override;
  void on_ended(std::size_t candidate, std::string_view reason) override;
  void on_heard(std::size_t candidate) override;
  void on_drained(std::size_t candidate) override;

  bool is_current(std::size_t candidate) const;
  void advance(Time now);
  bool attempt(std::size_t candidate, Time now);
  std::shared_ptr<Downstream> make_line(std::size_t candidate);
  void count(Refusal refusal);
  void note(std::size_t candidate, const std::string& reason);
  void tell(std::size_t candidate, std::string_view reason);
  void abandon(std::size_t candidate);
  void give_up_attempts(Time now);
  void cut();
  void use(std::size_t candidate);
  void lose(Successor::Loss loss, std::string_view reason);
  void hang_up(std::string_view reason);
  void tick(Time now);
  void tick_current(Time now);
  void tick_attempts(Time now);
  void write_idle();

  boost::asio::io_context& io_;
  OutputSettings settings_;
  OutputHandler& handler_;
  OutputCounters counters_;
  Refusals refusals_;
  ReportOnce report_once_;  ///< of a refusal, since the output came up
  Successor successor_;
  std::map<std::size_t, Attempt> attempts_;
  std::shared_ptr<Downstream> current_;
  Silence silence_;
  event_loop::Ticker ticker_;
  std::size_t ticks_ = 0;
  Wire wire_ = Wire::whole;
  bool wrote_ = false;  ///< since the last tick
  bool closed_ = false;
};

}  // namespace limb_ring::link
