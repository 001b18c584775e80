#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <functional>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "limb_ring/host_port.h"

namespace limb_ring::bench {

enum class Sending { one, all };
/// All processes of a ring on one core, or wherever the kernel puts them.
enum class Pinning { one_core, free };

/// What can be measured alone, beside the reference. `unix` has `watched` with it: the same ring, read along.
constexpr const char* kCases[] = {"unix",        "shm",    "udp",           "keyed",           "cpu_to_cpu",
                                  "judged",      "viewed", "recorded",      "placed",          "spin",
                                  "relay_chain", "idle",   "humanoid_1khz", "humanoid_virtual"};

/// What is to be measured, and how.
struct Setup {
  unsigned nodes = 16;                ///< 2 to 64
  std::size_t payload = kMaxPayload;  ///< bytes of data per packet, 4 to 512
  double seconds = 2;                 ///< per case, over all rounds
  unsigned rounds = 3;                ///< reference and rings take turns, because machines are noisy
  bool ros = true;                    ///< the chain of relays too, if ROS is there
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

/// `count` values of T in memory that this process shares with those it forks.
template <typename T>
class Shared {
 public:
  explicit Shared(std::size_t count) : count_(count) {
    memory_ = ::mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory_ == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "shared memory");
    for (std::size_t i = 0; i < count; ++i) new (begin() + i) T();
  }
  ~Shared() { ::munmap(memory_, bytes()); }
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;

  T& operator[](std::size_t index) { return begin()[index]; }
  T* begin() { return static_cast<T*>(memory_); }
  T* end() { return begin() + count_; }

 private:
  std::size_t bytes() const { return count_ * sizeof(T); }
  std::size_t count_;
  void* memory_;
};

constexpr std::chrono::milliseconds kTick{5};           ///< how often another process is polled for its end
constexpr std::chrono::milliseconds kSlice{50};         ///< how long a client waits for one message
constexpr std::chrono::milliseconds kPatience{10'000};  ///< how much longer than asked for something may take

}  // namespace limb_ring::bench
