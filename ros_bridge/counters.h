#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace limb_ring::bridge {

/// Counts what the bridge has received, sent and dropped, by name; shown in ring_status. Any thread.
class Counters {
 public:
  using Values = std::map<std::string, std::uint64_t>;

  void add(const std::string& name, std::uint64_t count = 1) {
    std::lock_guard<std::mutex> lock(mutex_);
    values_[name] += count;
  }
  void set(const std::string& name, std::uint64_t value) {
    std::lock_guard<std::mutex> lock(mutex_);
    values_[name] = value;
  }
  /// Like add(), for losses: what was dropped although somebody wanted it. /diagnostics warns of these.
  void lose(const std::string& name, std::uint64_t count = 1) {
    std::lock_guard<std::mutex> lock(mutex_);
    losses_[name] = values_[name] += count;
  }
  /// Like set(), for losses.
  void set_lost(const std::string& name, std::uint64_t value) {
    std::lock_guard<std::mutex> lock(mutex_);
    losses_[name] = values_[name] = value;
  }
  Values all() const {
    std::lock_guard<std::mutex> lock(mutex_);
    return values_;
  }
  /// Those of lose() and set_lost().
  Values losses() const {
    std::lock_guard<std::mutex> lock(mutex_);
    return losses_;
  }

 private:
  mutable std::mutex mutex_;
  Values values_, losses_;
};

}  // namespace limb_ring::bridge
