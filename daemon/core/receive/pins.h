#pragma once

#include "core/counters.h"
#include "core/events.h"
#include "core/membership/membership.h"
#include "core/receive/duplicate_memory.h"
#include "core/settings.h"

namespace limb_ring::core {

/// The interrupt pins of the NC: an INTP addressed to this node pulls the pin of its number, no
/// firmware involved. (paper) Only after a good CRC, and once per INTP. (ours, protocol.md section 5.3)
class Pins {
 public:
  Pins(const Settings& settings, DuplicateMemory& memory, Membership& membership, Counters& counters,
       EventQueue& events)
      : settings_(settings), memory_(memory), membership_(membership), counters_(counters), events_(events) {}

  /// An INTP of another node, with a good CRC, passes.
  /// @return the FBC it goes on with: 1 pin pulled, 0 pin wired to nothing
  std::uint8_t pass(const wire::PacketFields& packet, Time at) {
    return membership_.is_unheard_nodes_retry(packet) ? packet.fbc() : offer(packet, at);
  }
  /// The part of pass() that applies to an own INTP to this node, too. @param at when its last bit is in
  std::uint8_t offer(const wire::PacketFields& packet, Time at);

 private:
  using Verdict = DuplicateMemory::Verdict;
  bool addressed(const wire::PacketFields& packet) const;
  bool pull(const wire::PacketFields& packet, Time at);

  const Settings& settings_;
  DuplicateMemory& memory_;
  Membership& membership_;
  Counters& counters_;
  EventQueue& events_;
};

}  // namespace limb_ring::core
