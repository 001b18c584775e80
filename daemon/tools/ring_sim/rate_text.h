#pragma once

#include <cstdint>
#include <sstream>
#include <string>

namespace limb_ring::ring_sim {

/// A rate in Mbit/s as short as it can be said: 0.001, 2.5, 1000. @param rate bit/s
inline std::string megabits(std::uint64_t rate) {
  std::ostringstream text;
  text << static_cast<double>(rate) / 1e6;
  return text.str();
}

}  // namespace limb_ring::ring_sim
