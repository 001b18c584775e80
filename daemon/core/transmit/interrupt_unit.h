#pragma once

#include <algorithm>
#include <deque>

#include "core/send_request.h"
#include "core/transmit/send_unit.h"

namespace limb_ring::core {

/// The interrupt packet unit of Transmit, parallel to the data packet unit (paper): one INTP
/// outstanding, time-out and retries as for data, and never tried again for a refusal. (ours, protocol.md section 5.1)
class InterruptUnit final : public SendUnit {
 public:
  InterruptUnit(const Settings& settings, Counters& counters, EventQueue& events)
      : SendUnit(settings, counters, events) {}

  /// @return Reject::none where it was queued; its SendEnded comes later
  Reject enqueue(const InterruptRequest& request, Time now);

  bool has_work() const { return !queue_.empty(); }
  /// When it began, or will begin, to ask for the line; kNever: it does not.
  Time ready_at() const {
    if (flight_.phase() == Flight::Phase::waiting) return flight_.waiting_since();
    if (flight_.phase() == Flight::Phase::out || queue_.empty() || gate_ != Gate::open) return kNever;
    return std::max(queue_.front().asked, free_at_);
  }
  /// It gets the line. @return the packet that goes now. @pre ready_at() <= now
  wire::ByteView start(Time now);

  void handle_timeout(Time now) {
    if (has_work()) end_overdue(now);
  }
  Time deadline() const {
    if (queue_.empty()) return kNever;
    return flight_.idle() ? overdue_at(queue_.front()) : try_deadline();
  }

  /// Ends all sends of one owner `cancelled`; one that is out is no longer repeated.
  void cancel(Owner owner, Time now);
  /// Ends everything. The sequence numbers go on.
  void restart(Time now);
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    archive_unit(a);
    a("queue", queue_);
  }

 private:
  void end_overdue(Time now);
  Send& outstanding() override { return queue_.front(); }
  void pop_outstanding() override { queue_.pop_front(); }
  void count_return() override { ++counters_.returned_interrupts; }
  bool goes_again(Time) override { return false; }

  std::deque<Send> queue_;  ///< the front is outstanding unless flight_ is idle
};

}  // namespace limb_ring::core
