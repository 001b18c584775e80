#pragma once

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "study/plan.h"

namespace limb_ring::study {

using namespace std::chrono_literals;

/// Nodes a, b, c ... at 1 Gbit/s (8 ns a byte) and a relay delay of 1 us. Beacons are a minute apart, so
/// that hardly one comes in between.
inline config::RingConfig small_ring(std::size_t nodes) {
  config::RingConfig ring;
  ring.ring = "small";
  ring.timeouts.beacon = 60s;
  for (std::size_t n = 0; n < nodes; ++n) {
    config::NodeConfig node;
    node.id = static_cast<std::uint8_t>(n);
    node.name = std::string(1, static_cast<char>('a' + n));
    node.link.rate = 1'000'000'000;
    node.link.delay = 1us;
    ring.nodes.push_back(node);
  }
  return ring;
}

/// A packet of 88 bytes of data is 100 bytes on the line: 0.8 us.
constexpr unsigned kHundred = 88;

inline Stream stream_from(std::uint8_t source, std::uint8_t destination, std::vector<unsigned> packets, Duration period,
                          std::uint8_t priority = 0) {
  Stream stream;
  stream.name = "from " + std::to_string(source);
  stream.source = NodeId{source};
  stream.destination = NodeId{destination};
  stream.priority = priority;
  for (const unsigned packet : packets) stream.bytes += packet;
  stream.packets = std::move(packets);
  stream.period = period;
  return stream;
}

inline Stream interrupts_from(std::uint8_t source, std::uint8_t destination, std::uint8_t factor, Duration period) {
  Stream stream = stream_from(source, destination, {}, period);
  stream.interrupt = factor;
  return stream;
}

inline Duration ns(std::int64_t count) { return std::chrono::nanoseconds(count); }

}  // namespace limb_ring::study
