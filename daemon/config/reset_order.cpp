#include "config/reset_order.h"

namespace limb_ring::watchdog {

using core::Outcome;

namespace {

/// In quotes: not every outcome is a word that fits into a sentence ("no such node").
std::string words_of_end(const core::SendEnded& ended) {
  return std::string("the interrupt ended '") + to_string(ended.outcome) + '\'';
}

}  // namespace

CpuKnown known_of(const CpuSighting& cpu, bool heard, const Reach& reach) {
  return {cpu.boots, cpu.comes_back, cpu.state == wire::CpuState::absent, heard, reach};
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
  if (cpu.boots <= before_.boots) return std::nullopt;
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
