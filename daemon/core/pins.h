#pragma once

#include "core/counters.h"
#include "core/duplicate_memory.h"
#include "core/events.h"
#include "core/settings.h"

namespace limb_ring::core {

/// The interrupt pins of the NC: an INTP addressed to this node pulls the pin of its number, no
/// firmware involved. (paper) Only after a good CRC, and once per INTP. (ours)
class Pins {
 public:
  Pins(const Settings& settings, Counters& counters, EventQueue& events)
      : settings_(settings), counters_(counters), events_(events), memory_(settings.send_timeout()) {}

  /// An INTP with a good CRC passes.
  /// @return the FBC it goes on with: 1 pin pulled, 0 pin wired to nothing
  std::uint8_t offer(const wire::PacketFields& packet, Time at);

  void forget(NodeId source) { memory_.forget(source); }
  /// Unlike data, interrupts are taken while the own hello is out: retries of what was taken before
  /// have to be known until it is home.
  void start_over() { memory_.age_all(); }
  void joined() { memory_.forget_aged(); }

 private:
  using Verdict = DuplicateMemory::Verdict;
  bool addressed(const wire::PacketFields& packet) const;
  bool pull(const wire::PacketFields& packet, Time at);

  const Settings& settings_;
  Counters& counters_;
  EventQueue& events_;
  DuplicateMemory memory_;
};

}  // namespace limb_ring::core
