#pragma once

#include <chrono>
#include <utility>

#include "config/ring_config.h"
#include "process/process_handle.h"

namespace limb_ring::runtime {

/// The process that holds the CPU's place on the host port. No IO but its handle; time is given.
class AttachedCpu {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using milliseconds = std::chrono::milliseconds;

  AttachedCpu(process::ProcessHandle process, bool restarted_by_owner, milliseconds alive_period, Time now)
      : process_(std::move(process)),
        restarted_by_owner_(restarted_by_owner),
        alive_period_(alive_period),
        spoke_(now) {}

  const process::ProcessHandle& process() const { return process_; }
  process::ProcessHandle release() { return std::move(process_); }
  pid_t pid() const { return process_.pid(); }
  bool restarted_by_owner() const { return restarted_by_owner_; }
  milliseconds alive_period() const { return alive_period_; }
  milliseconds silent_for(Time now) const { return std::chrono::duration_cast<milliseconds>(now - spoke_); }
  void spoke(Time now) { spoke_ = now; }
  /// It promised to speak, and has not for three periods.
  bool silent(Time now) const { return promises() && now >= silent_at(); }
  bool promises() const { return alive_period_.count() > 0; }
  Time silent_at() const { return spoke_ + config::CpuConfig::kSilentPeriods * alive_period_; }

 private:
  process::ProcessHandle process_;
  bool restarted_by_owner_;
  milliseconds alive_period_;
  Time spoke_;
};

}  // namespace limb_ring::runtime
