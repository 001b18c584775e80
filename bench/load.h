#pragma once

#include <array>
#include <chrono>

#include "wire/packet.h"

namespace limb_ring::hops {

constexpr std::array<unsigned, 2> kSizes{16, 254};  ///< nodes of the rings measured

// What every ring here carries: each node always has one packet of 512 bytes under way, which goes
// all the way round and is followed by the next, at 1 Gbit/s with d = 512 ns.
constexpr unsigned kPayload = wire::kMaxPayload;
constexpr std::chrono::nanoseconds kByte{8};
constexpr std::chrono::nanoseconds kDelay{512};
constexpr std::chrono::nanoseconds kPacket = kByte * static_cast<int>(wire::kMaxDataPacketSize);

// The core's nodes begin at random within a lap, and are measured when every buffer has been used.
constexpr unsigned kSeed = 1;
constexpr unsigned kLapsBefore = 8;

/// Wall-clock time since it was made.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace limb_ring::hops
