#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "config/fault_name.h"
#include "wire/packet.h"

namespace limb_ring::fault {

using std::chrono::nanoseconds;
using wire::NodeId;

/// One fault, or the end of one, as a value. Which members count is in Word::keys.
struct Fault {
  Name name = Name::cut;
  std::vector<NodeId> nodes;  ///< the nodes it hits; for a line: the node from which the line leads
  bool second_line = false;   ///< for a line: the second one of a ring that folds back, against ring order

  std::uint64_t packets = 0;  ///< the next so many; 0: no limit
  std::uint64_t once_in = 1;  ///< ... each with the probability 1 / once_in
  nanoseconds lasts{0};       ///< for so long from its start; 0: until it is mended

  nanoseconds after{0};             ///< starts so much later
  std::uint64_t after_packets = 0;  ///< ... and not before so many DATPs of node `of` have passed the line
  NodeId of{0};                     ///< retries count for it, hellos and beacons do not

  nanoseconds delay{0};
  nanoseconds jitter{0};   ///< at random from 0 to this, on top of `delay`
  std::uint64_t rate = 0;  ///< bit/s
  nanoseconds every{0};    ///< a period: of flap, slow, babble
  std::uint64_t seed = 0;  ///< of its random choices; 0: drawn from the seed of the line
};

}  // namespace limb_ring::fault
