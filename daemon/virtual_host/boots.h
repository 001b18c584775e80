#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "config/ring_config.h"
#include "runtime/cpu/cpu_status.h"
#include "sim/virtual_ring.h"

namespace limb_ring::virtual_host {

/// CPUs of a virtual ring that boot, or whose process is ending. Each holds the clock at an instant that does not
/// depend on how long that really takes.
class Boots {
 public:
  /// True where nobody waits for the CPU of that node: the node is frozen, or the CPU stopped.
  using IsAway = std::function<bool(std::uint8_t node)>;
  /// Of real time, from its node's start, a CPU that others start is waited for: ROS nodes take some seconds.
  static constexpr std::chrono::seconds kAttachedWithin{30};
  /// All outlive this. No CPU before its boot_time is over.
  Boots(const sim::VirtualRing& ring, const config::RingConfig& config, IsAway is_away);

  /// Its CPU, where others start that, is waited for from now on if it is a bridge in lockstep.
  void expect_bridge(std::uint8_t node);
  /// The CPU of that node is such a one.
  bool is_bridge(std::uint8_t node) const;
  /// The CPU of a node has greeted. `attach` is called when its boot is over.
  /// @return false where nobody knew that it would come; `attach` was not called
  bool greeted(std::uint8_t node, const std::function<void()>& attach);
  /// What is known of the CPU process of a node has changed. @return true where it is a new one
  bool changed(std::uint8_t node, const runtime::CpuStatus& cpu);
  /// The process of a node is ending, from this instant on.
  void ends(std::uint8_t node);
  bool is_ending(std::uint8_t node) const;
  /// Nobody boots there any more.
  void forget(std::uint8_t node);
  /// It was away, and has its time from now on.
  void goes_on(std::uint8_t node);

  /// Time stands at that instant until those have come, or gone; kNever where there are none.
  core::Time held_at() const;
  /// Attaches those whose boot is over by now, in the order of the nodes, once all of them have come.
  /// @return false where one is still waited for
  bool attach_those_due();

 private:
  struct Boot {
    core::Time at{};
    bool ends = false;                  ///< the process there was before is ending
    std::function<void()> attach = {};  ///< empty until it has greeted
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
  };

  core::Time boot_end() const;
  bool is_late(std::uint8_t node, const Boot& boot) const;
  void give_up(std::uint8_t node, const Boot& boot) const;
  void give_up_late_ones();

  const sim::VirtualRing& ring_;
  const config::RingConfig& config_;
  IsAway is_away_;
  std::map<std::uint8_t, Boot> boots_;
  std::map<std::uint8_t, pid_t> pids_;  ///< the last one known
};

}  // namespace limb_ring::virtual_host
