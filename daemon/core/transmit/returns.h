#pragma once

#include "core/membership/membership.h"
#include "core/receive/pins.h"
#include "core/receive/receive.h"
#include "core/transmit/transmit.h"

namespace limb_ring::core {

/// Own packets that have come home. The return is the acknowledgement (paper). Its HOP says how many nodes the ring
/// has. A packet that this node never sent is a sign of a duplicate id. (ours, protocol.md sections 4.2, 4.7 and 8.6)
class Returns {
 public:
  Returns(const Settings& settings, Transmit& transmit, Membership& membership, Receive& receive, Pins& pins,
          Counters& counters)
      : settings_(settings),
        transmit_(transmit),
        membership_(membership),
        receive_(receive),
        pins_(pins),
        counters_(counters) {}

  /// @param good its CRC and trailer are right
  void data(const wire::PacketFields& packet, bool good, Time at);
  void interrupt(const wire::PacketFields& packet, bool good, Time at);
  /// A DATP came home, but not as a whole.
  void broken_off(Time now) { damaged(transmit_.data, now); }

 private:
  void damaged(SendUnit& unit, Time at);
  template <class Block>
  std::uint8_t fbc_of(const wire::PacketFields& packet, const SendUnit& unit, Block& block, Time at);
  bool match(SendUnit& unit, const wire::PacketFields& packet, std::uint8_t fbc, Time at);

  const Settings& settings_;
  Transmit& transmit_;
  Membership& membership_;
  Receive& receive_;
  Pins& pins_;
  Counters& counters_;
};

}  // namespace limb_ring::core
