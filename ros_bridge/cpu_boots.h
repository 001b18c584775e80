#pragma once

#include <cstdint>
#include <map>
#include <utility>

namespace limb_ring::bridge {

/// Notices CPUs that have been started again, from one beacon of their node to the next. (ours)
class CpuBoots {
 public:
  /// @param node_boot of the node's daemon
  /// @param cpu_boots starts of the CPU since its daemon started; 0: not known, or not yet
  /// @return the CPU was started again since it was last known to have started
  bool take(std::uint8_t node, std::uint64_t node_boot, std::uint32_t cpu_boots) {
    if (cpu_boots == 0) return false;
    const Boots now{node_boot, cpu_boots};
    const auto [known, is_new] = last_.emplace(node, now);
    const Boots before = std::exchange(known->second, now);
    return !is_new && (before.cpu != now.cpu || is_another_daemon(before.node, now.node));
  }

 private:
  struct Boots {
    std::uint64_t node;
    std::uint32_t cpu;
  };
  /// A daemon counts its boot number up by one when it starts over, and begins with the clock in ns (protocol.md
  /// section 4.8). So two numbers that are near belong to the same process, whose CPU may run on.
  static bool is_another_daemon(std::uint64_t before, std::uint64_t now) {
    constexpr std::uint64_t kNear = 1000;
    return now > before ? now - before > kNear : before - now > kNear;
  }

  std::map<std::uint8_t, Boots> last_;
};

}  // namespace limb_ring::bridge
