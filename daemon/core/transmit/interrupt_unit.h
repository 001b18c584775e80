#pragma once

#include <algorithm>
#include <deque>

#include "core/counters.h"
#include "core/transmit/data_unit.h"
#include "core/events.h"
#include "core/transmit/flight.h"
#include "core/send_request.h"
#include "core/transmit/sequence_numbers.h"
#include "core/settings.h"

namespace limb_ring::core {

/// The interrupt packet unit of Transmit, parallel to the data packet unit (paper): one INTP
/// outstanding, time-out and retries as for data, and never tried again for a refusal. (ours, protocol.md section 5.1)
class InterruptUnit {
 public:
  InterruptUnit(const Settings& settings, Counters& counters, EventQueue& events);

  Reject enqueue(const InterruptRequest& request, Time now);
  void set_gate(Gate gate, Time now) {
    gate_ = gate;
    free_at_ = std::max(free_at_, now);  // what waited at it asks for the line now, not when it was asked for
  }
  void set_open_chain(bool open, Time now);

  Time ready_at() const {
    if (flight_.phase() == Flight::Phase::waiting) return flight_.waiting_since();
    if (flight_.phase() == Flight::Phase::out || queue_.empty() || gate_ != Gate::open) return kNever;
    return std::max(queue_.front().asked, free_at_);
  }
  wire::ByteView start(Time now);
  bool busy() const { return !flight_.idle(); }
  /// It is what was sent last, and not home yet. @pre its CRC is good
  bool expects(const wire::PacketFields& packet) const { return flight_.is_return(packet); }

  /// @param doubtful the FBC proves nothing (Membership::has_merged): it ends lost
  bool returned(const wire::PacketFields& packet, std::uint8_t fbc, bool doubtful, Time at);
  void returned_damaged(Time at);
  void handle_timeout(Time now) {
    if (!queue_.empty()) end_overdue(now);
  }
  Time deadline() const { return queue_.empty() ? kNever : next_deadline(); }

  /// As DataUnit's.
  void forgotten_by(NodeId peer, Time now);
  void cancel(Owner owner, Time now);
  void restart(Time now);
  /// Its sequence numbers begin anew, in the incarnation of that boot number.
  void restart_numbers(std::uint64_t boot) { numbers_.restart(boot); }
  bool numbers_exhausted() const { return numbers_.exhausted(); }

 private:
  struct Job {
    InterruptRequest request;
    Time asked;
    unsigned tries = 0;
    bool repeated = false;
    bool forgotten = false;  ///< its receiver restarted while it was out: not repeated
    bool told = false;
  };

  void end_overdue(Time now);
  Time next_deadline() const;
  void fail_try(Time at);
  void give_up(Time at);
  void finish(Outcome outcome, Time at, Duration round_trip = Duration{0});
  void tell(Job& job, Outcome outcome, Time at, Duration round_trip);

  const Settings& settings_;
  Counters& counters_;
  EventQueue& events_;
  Gate gate_ = Gate::closed;
  bool open_chain_ = false;
  std::deque<Job> queue_;  ///< the front is in flight unless flight_ is idle
  Flight flight_;
  Time free_at_{};
  SequenceNumbers numbers_;
};

}  // namespace limb_ring::core
