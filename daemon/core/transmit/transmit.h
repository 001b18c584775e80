#pragma once

#include "core/transmit/data_unit.h"
#include "core/transmit/interrupt_unit.h"

namespace limb_ring::core {

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
