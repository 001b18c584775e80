#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "core/time.h"
#include "wire/packet.h"

namespace limb_ring::study {

using core::Duration;
using wire::NodeId;

/// Messages (or interrupts) that one node asks for again and again.
struct Stream {
  std::string name;
  NodeId source{0};                       ///< place in ring order, from 0; as is the destination
  NodeId destination{0};                  ///< or wire::kBroadcast
  std::uint8_t priority = 0;              ///< 0 (highest) to 3; means nothing for an interrupt
  bool beacon = false;                    ///< the NC's own: goes before priority 0
  unsigned bytes = 0;                     ///< of one message; 0 for an interrupt
  std::vector<unsigned> packets;          ///< bytes of data of each DATP of a message; empty for an interrupt
  std::optional<std::uint8_t> interrupt;  ///< factor 0 to 7
  Duration period{0};
  Duration jitter{0};             ///< asked for up to so much later than the period says
  Duration deadline{0};           ///< delivered later than so long after it was asked for, it is late; 0: its period
  std::optional<Duration> phase;  ///< first message so long after the start; none: any

  Duration late_after() const { return deadline == Duration{0} ? period : deadline; }
  double rate() const { return 1e12 / static_cast<double>(period.count()); }  ///< Hz
};

/// Every stream that a ring's file implies (ours), in this order:
///   joint states    of each node with joints, to config::body_of() (firmware)
///   joint commands  from there to each of them, position and velocity of every joint (ring_bridge)
///   sensors         to there (firmware)
///   topics          that have a size and a rate (ring_bridge); the announcement before the first is not counted
///   traffic
///   beacons         of every network controller
std::vector<Stream> streams_of(const config::RingConfig& ring);

}  // namespace limb_ring::study
