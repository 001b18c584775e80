#pragma once

#include <algorithm>
#include <deque>

#include "core/send_request.h"
#include "core/transmit/data_unit.h"
#include "core/transmit/send_unit.h"

namespace limb_ring::core {

/// The interrupt packet unit of Transmit, parallel to the data packet unit (paper): one INTP
/// outstanding, time-out and retries as for data, and never tried again for a refusal. (ours, protocol.md section 5.1)
class InterruptUnit final : public SendUnit {
 public:
  InterruptUnit(const Settings& settings, Counters& counters, EventQueue& events)
      : SendUnit(settings, counters, events) {}

  /// @return Reject::none if it was queued; its SendEnded comes later
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
    return flight_.idle() ? overdue_at(queue_.front()) : flight_.deadline();
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

/// Transmit: sends what the node asks for. Data packets and interrupt packets have separate,
/// parallel units. (paper, protocol.md section 2.1)
class Transmit {
 public:
  Transmit(const Settings& settings, Counters& counters, EventQueue& events)
      : data(settings, counters, events),
        interrupts(settings, counters, events),
        settings_(settings),
        counters_(counters),
        events_(events) {}

  DataUnit data;
  InterruptUnit interrupts;

  /// @name What is asked for. Every call ends in exactly one SendEnded event.
  /// @param in_ring users may send (Membership::accepts_sends); if not, it is rejected
  ///@{
  void send(const SendRequest& request, bool in_ring, Time now);
  void interrupt(const InterruptRequest& request, bool in_ring, Time now);
  /// Pulls interrupt input 0..7: sends the INTP it is wired to, without the CPU. (paper, protocol.md section 5.4)
  void pull(Owner owner, std::uint32_t token, unsigned input, bool in_ring, Time now);
  void cancel(Owner owner, Time now) {
    data.cancel(owner, now);
    interrupts.cancel(owner, now);
  }
  ///@}

  void set_gate(Gate gate, Time now) {
    data.set_gate(gate, now);
    interrupts.set_gate(gate, now);
  }
  void set_open_chain(bool open, Time now) {
    data.set_open_chain(open, now);
    interrupts.set_open_chain(open, now);
  }
  bool idle() const { return !data.busy() && !interrupts.busy(); }
  bool numbers_exhausted() const { return data.numbers_exhausted() || interrupts.numbers_exhausted(); }
  void restart_numbers(std::uint64_t boot) {
    data.restart_numbers(boot);
    interrupts.restart_numbers(boot);
  }
  void restart(Time now) {
    data.restart(now);
    interrupts.restart(now);
  }
  void forgotten_by(NodeId peer, Time now) {
    data.forgotten_by(peer, now);
    interrupts.forgotten_by(peer, now);
  }
  void handle_timeout(Time now) {
    data.handle_timeout(now);
    interrupts.handle_timeout(now);
  }
  Time deadline() const { return std::min(data.deadline(), interrupts.deadline()); }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("data", data)("interrupts", interrupts);
  }

 private:
  bool exists(NodeId destination) const {
    return destination == wire::kBroadcast || is_in(settings_.order, destination);
  }
  Reject check(const SendRequest& request) const;
  Reject check(const InterruptRequest& request) const;
  template <class Request>
  void reject(const Request& request, Reject reason, Time now);

  const Settings& settings_;
  Counters& counters_;
  EventQueue& events_;
};

}  // namespace limb_ring::core
