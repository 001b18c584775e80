#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace limb_ring::bridge {

/// What the bridge has taken, sent and thrown away, by name; shown in ring_status. Any thread.
class Counters {
 public:
  void add(const std::string& name, std::uint64_t count = 1) {
    std::lock_guard<std::mutex> lock(mutex_);
    values_[name] += count;
  }
  void set(const std::string& name, std::uint64_t value) {
    std::lock_guard<std::mutex> lock(mutex_);
    values_[name] = value;
  }
  std::map<std::string, std::uint64_t> all() const {
    std::lock_guard<std::mutex> lock(mutex_);
    return values_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::uint64_t> values_;
};

}  // namespace limb_ring::bridge
