#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "limb_ring/host_port.h"

namespace limb_ring::bench {

enum class Sending { one, all };
/// All processes of a ring on one core, or wherever the kernel puts them.
enum class Pinning { one_core, free };

/// What can be measured alone, beside the reference. `unix` has `watched` with it: the same ring, read along.
constexpr const char* kCases[] = {
    "unix",   "shm",  "udp",         "keyed", "cpu_to_cpu",    "judged",          "recorded",
    "placed", "spin", "relay_chain", "idle",  "humanoid_1khz", "humanoid_virtual"};

/// What is to be measured, and how.
struct Setup {
  unsigned nodes = 16;                ///< 2 to 64
  std::size_t payload = kMaxPayload;  ///< bytes of data per packet, 4 to 512
  double seconds = 2;                 ///< per case, over all rounds
  unsigned rounds = 3;                ///< reference and rings take turns, because machines are noisy
  bool ros = true;                    ///< the chain of relays too, where ROS is there
  std::string humanoid;               ///< its YAML file; empty: not measured
  std::vector<std::string> only;      ///< of kCases; empty: all
  /// Called many times a second while something is waited for; throws to end the benchmark.
  std::function<void()> poll = [] {};
  /// What is being measured now, for people.
  std::function<void(const std::string&)> tell = [](const std::string&) {};

  bool wants(const std::string& what) const {
    return only.empty() || std::find(only.begin(), only.end(), what) != only.end();
  }
  std::chrono::milliseconds case_time() const { return std::chrono::milliseconds(static_cast<int>(seconds * 1000)); }
  double round_seconds() const { return seconds / rounds; }
};

}  // namespace limb_ring::bench
