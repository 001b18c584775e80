#pragma once

#include "study/analysis/medium.h"

namespace limb_ring::study {

/// How many packets make a distribution: a second or two of work for any number of nodes.
inline std::int64_t packet_count(const Medium& medium) {
  constexpr std::int64_t kPacketHops = 1'600'000;
  return kPacketHops / medium.nodes;
}

}  // namespace limb_ring::study
