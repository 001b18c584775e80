#include "node/virtual_boots.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <vector>

namespace limb_ring::virtual_host {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

namespace {

/// Real time: how long a process may take to end after it was killed, or was sent a signal that it may catch.
constexpr std::chrono::seconds kEndsWithin{10};

}  // namespace

Boots::Boots(const sim::VirtualRing& ring, const config::RingConfig& config, IsAway is_away)
    : ring_(ring), config_(config), is_away_(std::move(is_away)) {}

/// When a CPU that begins to boot now has booted. Rounded to ns, like the clock of its node.
core::Time Boots::boot_end() const {
  const auto now = std::chrono::floor<nanoseconds>(ring_.now().time_since_epoch());
  return core::Time{} + now + config_.virtual_clock.boot_time;
}

// The bridge has to be there from the start, because a robot's controller is.
void Boots::expect_bridge(std::uint8_t node) {
  if (is_bridge(node)) boots_[node] = {boot_end()};
}

bool Boots::is_bridge(std::uint8_t node) const {
  return !config_.bridge.lockstep.empty() && config_.find(node)->cpu.kind == config::CpuConfig::Kind::attached;
}

// ---- who comes ------------------------------------------------------------------------------

bool Boots::greeted(std::uint8_t node, const std::function<void()>& attach) {
  const auto boot = boots_.find(node);
  if (boot == boots_.end()) return false;
  if (boot->second.ends)
    attach();  // the attempt is refused
  else
    boot->second.attach = attach;
  return true;
}

void Boots::left(std::uint8_t node) {
  const auto boot = boots_.find(node);
  if (boot == boots_.end()) return;
  boot->second.attach = nullptr;
  boot->second.since = steady_clock::now();
}

// A new process is booting; cpu.ending means that the previous one is ending.
bool Boots::changed(std::uint8_t node, const runtime::CpuStatus& cpu) {
  const bool child = cpu.kind == runtime::CpuKind::child;
  const bool boots = child && cpu.state == wire::CpuState::booting && cpu.pid > 0;
  const bool was_ending = is_ending(node);
  if (cpu.ending) {
    ends(node);
  } else if (!boots) {
    if (was_ending ? cpu.pid <= 0 : child) drop(node);
  } else if (std::exchange(pids_[node], cpu.pid) != cpu.pid) {
    boots_[node] = {boot_end()};
    return true;
  } else {
    boots_.emplace(node, Boot{ring_.now()});
  }
  return false;
}

// Who has greeted in place of the child that is gone would wait for ever. Where it was the child, it is refused.
void Boots::drop(std::uint8_t node) {
  const auto dropped = boots_.extract(node);
  if (!dropped.empty() && dropped.mapped().attach) dropped.mapped().attach();
}

void Boots::ends(std::uint8_t node) { boots_[node] = {ring_.now(), true}; }

bool Boots::is_ending(std::uint8_t node) const {
  const auto boot = boots_.find(node);
  return boot != boots_.end() && boot->second.ends;
}

void Boots::forget(std::uint8_t node) {
  boots_.erase(node);
  pids_.erase(node);
}

void Boots::goes_on(std::uint8_t node) {
  const auto boot = boots_.find(node);
  if (boot == boots_.end()) return;
  boot->second.at = std::max(boot->second.at, ring_.now());
  boot->second.since = steady_clock::now();
}

// ---- who is waited for ----------------------------------------------------------------------

core::Time Boots::held_at() const {
  core::Time earliest = core::kNever;
  for (const auto& [node, boot] : boots_)
    if (!is_away_(node)) earliest = std::min(earliest, boot.at);
  return earliest;
}

bool Boots::attach_those_due() {
  give_up_late_ones();
  const auto is_due = [this](std::uint8_t node, const Boot& boot) { return boot.at <= ring_.now() && !is_away_(node); };
  std::vector<std::function<void()>> due;
  for (const auto& [node, boot] : boots_) {
    if (!is_due(node, boot)) continue;
    if (!boot.attach) return false;
    due.push_back(boot.attach);
  }
  for (auto it = boots_.begin(); it != boots_.end();)
    it = is_due(it->first, it->second) ? boots_.erase(it) : std::next(it);
  for (const auto& attach : due) attach();
  return true;
}

void Boots::give_up_late_ones() {
  for (auto it = boots_.begin(); it != boots_.end();) {
    const bool late = is_late(it->first, it->second);
    if (late) give_up(it->first, it->second);
    it = late ? boots_.erase(it) : std::next(it);
  }
}

/// True if a CPU that others start has not come in time, or a process that was to end has not.
bool Boots::is_late(std::uint8_t node, const Boot& boot) const {
  const bool by_others = config_.find(node)->cpu.kind == config::CpuConfig::Kind::attached;
  if (boot.attach || is_away_(node) || !(boot.ends || by_others)) return false;
  return steady_clock::now() - boot.since > (boot.ends ? kEndsWithin : kAttachedWithin);
}

void Boots::give_up(std::uint8_t node, const Boot& boot) const {
  const std::string& name = config_.find(node)->name;
  if (boot.ends)
    spdlog::warn("{}: its CPU was to end and has not within {} s; time goes on", name, kEndsWithin.count());
  else
    spdlog::warn("{}: bridge.lockstep: its CPU, the bridge, has not come within {} s; time goes on without it", name,
                 kAttachedWithin.count());
}

}  // namespace limb_ring::virtual_host
