#include "config/watchdog.h"

#include <algorithm>
#include <utility>

namespace limb_ring::watchdog {
namespace {

using std::chrono::milliseconds;

std::string text_of(core::Duration time) {
  return std::to_string(std::chrono::duration_cast<milliseconds>(time).count()) + " ms";
}

}  // namespace

CpuSighting sighting_of(const core::Peer& peer) {
  const wire::Beacon& beacon = peer.beacon;
  return {peer.beacon_heard ? std::make_optional(peer.beacon_at) : std::nullopt,
          beacon.cpu_boots,
          beacon.cpu_state,
          milliseconds(beacon.cpu_silent_ms),
          beacon.cpu_comes_back,
          peer.boot};
}

const char* to_string(CpuVerdict verdict) {
  switch (verdict) {
    case CpuVerdict::unheard:
      return "unheard";
    case CpuVerdict::booting:
      return "booting";
    case CpuVerdict::alive:
      return "alive";
    case CpuVerdict::hung:
      return "hung";
    case CpuVerdict::absent:
      return "absent";
    case CpuVerdict::unreachable:
      return "unreachable";
  }
  return "?";
}

const char* to_string(config::SupervisorConfig::Policy policy) {
  switch (policy) {
    case config::SupervisorConfig::Policy::off:
      return "off";
    case config::SupervisorConfig::Policy::report:
      return "report";
    case config::SupervisorConfig::Policy::automatic:
      return "auto";
  }
  return "?";
}

std::vector<wire::NodeId> watched_in(const config::RingConfig& ring) {
  std::vector<wire::NodeId> watched;
  for (const auto& node : ring.nodes)
    if (node.cpu.alive_period.count() != 0) watched.emplace_back(node.id);
  return watched;
}

Watchdog::Watchdog(const config::SupervisorConfig& settings, core::Duration missing_after,
                   const std::vector<wire::NodeId>& watched)
    : settings_(settings), missing_after_(missing_after) {
  for (const wire::NodeId node : watched) cpus_.emplace_back().node = node;
}

std::vector<WatchedCpu> Watchdog::watched() const { return {cpus_.begin(), cpus_.end()}; }

Watchdog::Round Watchdog::evaluate(const SightingOf& sighting_of, core::Time now) {
  slept_ = looked_at_ && now - *looked_at_ >= missing_after_;
  looked_at_ = now;
  for (Entry& cpu : cpus_) {
    if (settings_.policy == Policy::off) break;
    const CpuSighting seen = sighting_of(cpu.node);
    evaluate(cpu, seen, now);
    if (settings_.policy == Policy::automatic) cure(cpu, seen, now);
  }
  return std::exchange(round_, {});
}

// ---- verdicts -----------------------------------------------------------------------------

void Watchdog::evaluate(Entry& cpu, const CpuSighting& seen, core::Time now) {
  if (seen.heard_at && now - *seen.heard_at < missing_after_) return judge(cpu, seen, now);
  if (slept_ || cpu.verdict == CpuVerdict::unheard) return;
  enter(cpu, CpuVerdict::unreachable, "no beacon of its node for " + text_of(missing_after_), now);
}

void Watchdog::judge(Entry& cpu, const CpuSighting& seen, core::Time now) {
  if (seen.boots != cpu.boots) booted(cpu, seen.boots, now);
  // While a hung CPU is being reset, "booting" or "absent" only shows the process just killed: it is not cured yet.
  const bool cured_yet = !(cpu.verdict == CpuVerdict::hung && cpu.under_reset);
  switch (seen.state) {
    case wire::CpuState::running:
      return speaks(cpu, now);
    case wire::CpuState::silent:
      if (now < cpu.booted_at + settings_.grace) return enter(cpu, CpuVerdict::booting, "silent within its grace", now);
      return enter(cpu, CpuVerdict::hung, "silent for " + text_of(seen.silent), now);
    case wire::CpuState::booting:
      if (cured_yet) enter(cpu, CpuVerdict::booting, "its process runs", now);
      return;
    case wire::CpuState::none:
    case wire::CpuState::absent:
    case wire::CpuState::failed:
      if (cured_yet) enter(cpu, CpuVerdict::absent, wire::to_string(seen.state), now);
      return;
  }
}

void Watchdog::speaks(Entry& cpu, core::Time now) {
  enter(cpu, CpuVerdict::alive, cpu.verdict == CpuVerdict::hung ? "it speaks again by itself" : cpu.boot, now);
  cpu.given_up = false;
  if (!cpu.order_out) cpu.under_reset = false;
  if (cpu.tries > 0 && now - cpu.since >= settings_.grace + wait_after(cpu.tries)) cpu.tries = 0;
}

// A lower boot number is not a cure: the whole daemon of that node was restarted.
void Watchdog::booted(Entry& cpu, std::uint32_t boots, core::Time now) {
  const bool cured = cpu.under_reset && boots > *cpu.boots;
  if (cured) ++cpu.confirmed;
  cpu.boot = (cured ? "reset confirmed, boot " : "boot ") + std::to_string(boots);
  cpu.boots = boots;
  cpu.booted_at = cpu.since = now;
  cpu.verdict = CpuVerdict::booting;
  cpu.under_reset = cpu.order_out = cpu.given_up = false;
}

void Watchdog::enter(Entry& cpu, CpuVerdict verdict, const std::string& why, core::Time now) {
  if (cpu.verdict == verdict) return;
  cpu.verdict = verdict;
  cpu.since = now;
  if (verdict == CpuVerdict::hung) ++cpu.hangs;
  find(cpu, why);
}

void Watchdog::find(Entry& cpu, const std::string& what) {
  cpu.last = what;
  round_.findings.push_back({cpu.node, cpu.verdict, what});
}

// ---- the cure -----------------------------------------------------------------------------

void Watchdog::cure(Entry& cpu, const CpuSighting& seen, core::Time now) {
  if (cpu.verdict != CpuVerdict::hung || cpu.given_up || cpu.order_out) return;
  if (!seen.comes_back) return give_up(cpu, "not reset: nobody would start it again");
  if (cpu.tries >= settings_.tries) return give_up(cpu, "given up: it hangs after " + of_tries(cpu));
  if (now >= cpu.next_reset) order(cpu, seen, now);
}

void Watchdog::order(Entry& cpu, const CpuSighting& seen, core::Time now) {
  ++cpu.tries;
  ++cpu.resets;
  cpu.under_reset = cpu.order_out = true;
  cpu.next_reset = now + wait_after(cpu.tries);
  cpu.reset_reason = "silent for " + text_of(seen.silent);
  find(cpu, of_tries(cpu) + " ordered");
  round_.resets.push_back(cpu.node);
}

void Watchdog::give_up(Entry& cpu, const std::string& why) {
  cpu.given_up = true;
  find(cpu, why);
}

std::optional<Watchdog::Finding> Watchdog::reset_ended(wire::NodeId node, bool success, const std::string& message,
                                                       core::Time now) {
  const auto cpu = std::find_if(cpus_.begin(), cpus_.end(), [node](const Entry& entry) { return entry.node == node; });
  if (cpu == cpus_.end() || !std::exchange(cpu->order_out, false) || success) return std::nullopt;
  cpu->next_reset = now + wait_after(cpu->tries);
  cpu->given_up = cpu->verdict == CpuVerdict::hung && cpu->tries >= settings_.tries;
  cpu->last = of_tries(*cpu) + " failed" + (cpu->given_up ? ", given up: " : ": ") + message;
  return Finding{node, cpu->verdict, cpu->last};
}

std::string Watchdog::of_tries(const Entry& cpu) const {
  return "reset " + std::to_string(cpu.tries) + " of " + std::to_string(settings_.tries);
}

// The chain begins at the node behind the broken line and ends at the one before it.
Reach reach_of(const core::RingOrder& order, const std::optional<core::BrokenLine>& broken, wire::NodeId from,
               wire::NodeId to) {
  if (!broken) return {};
  const auto in_chain = [&](wire::NodeId node) { return core::distance(order, broken->behind, node); };
  return {in_chain(from) < in_chain(to), in_chain(to) <= in_chain(from)};
}

using core::Outcome;

namespace {

/// In quotes: not every outcome is a word that fits into a sentence ("no such node").
std::string words_of_end(const core::SendEnded& ended) {
  return std::string("the interrupt ended '") + to_string(ended.outcome) + '\'';
}

}  // namespace

CpuKnown known_of(const CpuSighting& cpu, bool heard, const Reach& reach) {
  return {cpu.boots, cpu.comes_back, cpu.state == wire::CpuState::absent, heard,
          reach,     cpu.node_boot,  cpu.state == wire::CpuState::running};
}

const char* to_string(Effect effect) {
  switch (effect) {
    case Effect::none:
      return "none";
    case Effect::unknown:
      return "unknown";
    case Effect::seen:
      return "seen";
  }
  return "?";
}

ResetOrder::Report ResetOrder::interrupt_ended(const core::SendEnded& ended, const CpuKnown& cpu, core::Time now) {
  report_.ended = ended;
  if (ended.outcome == Outcome::unconfirmed || ended.outcome == Outcome::lost) return in_doubt(cpu, now);
  if (ended.outcome != Outcome::delivered) return end(Effect::none, words_of_end(ended), now);
  phase_ = Phase::pulled;
  if (!before_.comes_back && before_.absent)
    return end(Effect::none, "the reset pin was pulled, but no CPU is attached to that node: nothing to reset", now);
  if (!before_.comes_back)
    return end(Effect::none, "the CPU was killed, but nobody restarts it: it did not declare that its owner does", now);
  return cpu_changed(cpu, now);
}

ResetOrder::Report ResetOrder::in_doubt(const CpuKnown& cpu, core::Time now) {
  phase_ = Phase::doubtful;
  if (!cpu.reach.sends) return end(Effect::none, "not reset", now);
  if (!cpu.reach.hears || !cpu.heard) return end(Effect::unknown, "that node cannot be heard from here", now);
  return cpu_changed(cpu, now);
}

ResetOrder::Report ResetOrder::cpu_changed(const CpuKnown& cpu, core::Time now) {
  if (phase_ == Phase::sent) return std::nullopt;  // not for a boot that was under way anyway
  report_.boots = cpu.boots;
  const bool with_its_node = cpu.node_boot > before_.node_boot && before_.node_boot != 0 && cpu.runs;
  if (cpu.boots <= before_.boots && !with_its_node) return std::nullopt;
  if (phase_ == Phase::pulled) return end(Effect::seen, "the CPU has booted again", now);
  return end(Effect::seen, words_of_end(report_.ended) + ", but the CPU has booted again: seen by its node's beacon",
             now);
}

ResetReport ResetOrder::timed_out(core::Time now) {
  switch (phase_) {
    case Phase::sent:
      return end(Effect::unknown, "the interrupt has not come home in time", now);
    case Phase::pulled:
      return end(Effect::none, "the reset pin was pulled, but no CPU has come back in time", now);
    case Phase::doubtful:
      break;
  }
  return end(Effect::unknown, "its node's beacons show no new boot so far", now);
}

ResetReport ResetOrder::end(Effect effect, const std::string& message, core::Time now) {
  report_.effect = effect;
  report_.message = message;
  report_.lasted = now - begun_;
  return report_;
}

}  // namespace limb_ring::watchdog
