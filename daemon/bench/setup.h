#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace limb_ring::bench {

enum class Sending { one, all };
/// All processes of a ring on one core, or wherever the kernel puts them.
enum class Pinning { one_core, free };

/// What is to be measured, and how.
struct Setup {
  unsigned nodes = 16;        ///< 2 to 255
  std::size_t payload = 512;  ///< bytes of data per packet, 4 to 512
  double seconds = 2;         ///< per case, over all rounds
  unsigned rounds = 3;        ///< reference and rings take turns, because machines are noisy
  bool ros = true;            ///< the chain of relays too, where ROS is there
  std::string humanoid;       ///< its YAML file; empty: not measured
  /// Called many times a second while something is waited for; throws to end the benchmark.
  std::function<void()> poll = [] {};
  /// What is being measured now, for people.
  std::function<void(const std::string&)> tell = [](const std::string&) {};

  double round_seconds() const { return seconds / rounds; }
};

}  // namespace limb_ring::bench
