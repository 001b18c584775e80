#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>

#include "config/ring_config.h"
#include "node/cpu_status.h"
#include "sim/virtual_ring.h"

namespace limb_ring::virtual_host {

/// CPUs of a virtual ring that boot, or whose process is ending. Each stops the ring's clock at a fixed instant until
/// that is over, so that a run does not depend on how long it really takes.
class Boots {
 public:
  /// True where nobody waits for the CPU of that node: the node is frozen, or the CPU stopped.
  using IsAway = std::function<bool(std::uint8_t node)>;
  /// How long, in real time from its node's start, to wait for a CPU that others start: ROS nodes take some seconds.
  static constexpr std::chrono::seconds kAttachedWithin{30};
  /// All outlive this. No CPU attaches before its boot_time is over.
  Boots(const sim::VirtualRing& ring, const config::RingConfig& config, IsAway is_away);

  /// From now on waits for the node's CPU, if that is a bridge in lockstep, which others start.
  void expect_bridge(std::uint8_t node);
  /// The CPU of that node is a bridge in lockstep.
  bool is_bridge(std::uint8_t node) const;
  /// The CPU of a node has greeted. `attach` is called when its boot is over.
  /// @return false if it was not expected; `attach` was not called
  bool greeted(std::uint8_t node, const std::function<void()>& attach);
  /// That CPU is gone: another one is waited for.
  void left(std::uint8_t node);
  /// What is known of the CPU process of a node has changed. @return true where it is a new one
  bool changed(std::uint8_t node, const runtime::CpuStatus& cpu);
  /// The process of a node is ending, from this instant on.
  void ends(std::uint8_t node);
  bool is_ending(std::uint8_t node) const;
  /// Nobody boots there any more.
  void forget(std::uint8_t node);
  /// Called when the node is no longer away: its time limits start again now.
  void goes_on(std::uint8_t node);

  /// The instant at which time stands until these CPUs have come or gone; kNever if there are none.
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
  void drop(std::uint8_t node);
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
