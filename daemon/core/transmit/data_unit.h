#pragma once

#include <algorithm>
#include <array>
#include <deque>

#include "core/counters.h"
#include "core/events.h"
#include "core/transmit/flight.h"
#include "core/send_request.h"
#include "core/transmit/sequence_numbers.h"
#include "core/settings.h"
#include "core/slot_queue.h"

namespace limb_ring::core {

/// What a unit of Transmit may send.
enum class Gate : std::uint8_t {
  closed,   ///< nothing
  control,  ///< the NC's own hello only
  open
};

/// The data packet unit of Transmit: a queue per priority, one DATP outstanding, its return the
/// acknowledgement. (paper) Time-out, retry, refusal and results are ours (protocol.md
/// sections 4.3 to 4.6).
class DataUnit {
 public:
  DataUnit(const Settings& settings, Counters& counters, EventQueue& events);

  /// @return Reject::none where it was queued; its SendEnded comes later
  Reject enqueue(const SendRequest& request, Time now);
  /// Hello or beacon: a broadcast on channel 1, before everything else.
  void enqueue_control(wire::ByteView message, std::uint32_t token, Time now);
  /// Takes the NC's own packets out of the queue, without an end. @pre !busy()
  void drop_control() {
    jobs_ -= queues_[kControlQueue].size();
    queues_[kControlQueue].clear();
  }

  void set_gate(Gate gate, Time now) {
    gate_ = gate;
    free_at_ = std::max(free_at_, now);  // what waited at it asks for the line now, not when it was asked for
  }
  /// Open chain: nothing returns, so every send ends `unconfirmed` as it leaves, at this pace.
  void set_open_chain(bool open, Time now);

  /// Since when (or from when on) it asks for the line; kNever where it does not.
  Time ready_at() const {
    if (flight_.phase() == Flight::Phase::waiting) return flight_.waiting_since();
    if (flight_.phase() == Flight::Phase::out || jobs_ == 0) return kNever;
    return next_ready();
  }
  /// The line is its own: the packet that goes now. @pre ready_at() <= now
  wire::ByteView start(Time now);
  /// True while a packet is out, or waits for its retry.
  bool busy() const { return !flight_.idle(); }
  /// It is what was sent last, and not home yet. @pre its CRC is good
  bool expects(const wire::PacketFields& packet) const { return flight_.is_return(packet); }

  /// An own packet came home with a good CRC; `fbc` what the receivers wrote.
  /// @return true where it was the one outstanding
  /// @param doubtful the FBC proves nothing (Membership::has_merged): it ends lost
  bool returned(const wire::PacketFields& packet, std::uint8_t fbc, bool doubtful, Time at);
  /// An own packet came home damaged or broken off: a failed try.
  void returned_damaged(Time at);

  void handle_timeout(Time now);
  Time deadline() const {
    if (!any_waits()) return flight_.deadline();
    return waiting_deadline();
  }

  /// `peer` has restarted and forgotten what it took. What it may have taken before is not repeated: it would take it
  /// twice. (ours, protocol.md section 4.10)
  void forgotten_by(NodeId peer, Time now);

  /// Ends all sends of one owner `cancelled`; one that is out is no longer repeated.
  void cancel(Owner owner, Time now);
  /// Ends everything, the NC's own too. New numbers are due then.
  void restart(Time now);
  /// Its sequence numbers begin anew, in the incarnation of that boot number.
  void restart_numbers(std::uint64_t boot) { numbers_.restart(boot); }
  bool numbers_exhausted() const { return numbers_.exhausted(); }

  bool has_control_end() const { return !control_ends_.empty(); }
  /// Ends of the NC's own sends since the last call, at most one at a time.
  bool take_control_end(SendEnded& out);

 private:
  struct JobState {
    Owner owner = kController;
    std::uint32_t token = 0;
    NodeId destination = 0;
    std::uint8_t pri = 0;
    Time asked{};
    Time not_before{};          ///< held back after a refusal
    Duration backoff{};         ///< next hold
    Time refused_until = kNever;
    unsigned tries = 0;
    bool repeated = false;      ///< some try had to be repeated: an earlier one may have been taken
    bool forgotten = false;     ///< its receiver restarted while it was out: not repeated
    bool told = false;          ///< its result was given already (cancelled while out)
    std::uint16_t size = 0;
  };
  struct Job : JobState {
    std::array<std::uint8_t, wire::kMaxPayload> data;
  };
  using Queue = SlotQueue<Job>;
  static constexpr std::size_t kControlQueue = 0;
  static constexpr std::size_t kQueues = 5;  ///< control, then priorities 0 to 3

  /// True where something waits for the line, or for its time.
  bool any_waits() const { return jobs_ > (flight_.phase() == Flight::Phase::out ? 1u : 0u); }
  Time next_ready() const;
  Time waiting_deadline() const;
  void pop(Queue& queue) {
    queue.pop();
    --jobs_;
  }
  void push(Queue& queue, const SendRequest& request, Time now);
  Time front_ready(std::size_t queue) const;
  std::size_t choose(Time now) const;
  void load(Job& job);
  Job& current() { return queues_[current_].front(); }
  static Outcome overdue_outcome(const Job& job);
  void end_doubtful_refused(NodeId peer, Time now);
  void fail_try(Time at);
  void give_up(Time at);
  void refuse(Time at);
  void decide(std::uint8_t fbc, Time at, Duration round_trip);
  void finish(std::size_t queue, Outcome outcome, Time at, Duration round_trip = Duration{0});
  void tell(Job& job, Outcome outcome, Reject reject, Time at, Duration round_trip);
  void finish_flight(Outcome outcome, Time at, Duration round_trip = Duration{0});

  const Settings& settings_;
  Counters& counters_;
  EventQueue& events_;
  Gate gate_ = Gate::closed;
  bool open_chain_ = false;
  std::array<Queue, kQueues> queues_;
  std::size_t jobs_ = 0;     ///< in all of them
  std::size_t current_ = 0;  ///< queue whose front is in flight
  Flight flight_;
  Time free_at_{};           ///< not before: the tail of the last return is in, or the gate was opened
  SequenceNumbers numbers_;
  std::deque<SendEnded> control_ends_;
};

/// Counts the end of a send under its outcome.
void count_outcome(Counters& counters, Outcome outcome);

}  // namespace limb_ring::core
