#include "sim/cpus.h"

namespace limb_ring::scenario {

namespace {

/// From its death to the next start, as the daemon's default. (ours)
constexpr std::chrono::milliseconds kBackOff{100};

}  // namespace

Cpus::Cpus(sim::VirtualRing& ring, core::Duration boot_time) : ring_(ring), boot_time_(boot_time), cpus_(ring.size()) {
  for (unsigned id = 0; id < ring.size(); ++id) tell(static_cast<NodeId>(id), wire::CpuState::running);
}

void Cpus::tell(NodeId id, wire::CpuState state) {
  cpus_[id].state = state;
  if (state != wire::CpuState::silent) cpus_[id].spoke_at = ring_.now();
  core::CpuReport report;
  report.boots = cpus_[id].boots;
  report.state = state;
  report.spoke_at = cpus_[id].spoke_at;
  ring_.node(id).set_cpu(report, ring_.now());
}

void Cpus::read(NodeId id, bool reads) {
  ring_.set_cpu_reads(id, reads);
  cpus_[id].slow = false;
  ++cpus_[id].reading;
}

void Cpus::hang(NodeId id) {
  if (has_crashed(id)) return;
  cpus_[id].running = cpus_[id].boots_later = false;
  read(id, false);
  cpus_[id].spoke_at = ring_.now();
  const core::Duration silent_after = config::CpuConfig::kSilentPeriods * kAlivePeriod;
  ring_.at(ring_.now() + silent_after, [this, id, epoch = ++cpus_[id].epoch] {
    if (cpus_[id].epoch == epoch && ring_.alive(id)) tell(id, wire::CpuState::silent);
  });
}

// One that boots goes on booting; one that hung meanwhile has booted now.
void Cpus::resume(NodeId id) {
  if (cpus_[id].boots_later) return;
  if (!cpus_[id].booted) return boot(id);
  run(id);
}

void Cpus::run(NodeId id) {
  cpus_[id].running = true;
  ++cpus_[id].epoch;
  ++cpus_[id].generation;
  read(id, true);
  tell(id, wire::CpuState::running);
}

void Cpus::stop_reading(NodeId id) { read(id, false); }

void Cpus::slow_down(NodeId id, core::Duration period) {
  read(id, false);
  cpus_[id].slow = true;
  read_one_and_wait(id, period);
}

// From now on it may take one packet. node() wakes the controller, so that a waiting packet is taken at once.
void Cpus::read_one_and_wait(NodeId id, core::Duration period) {
  ring_.set_cpu_reads(id, true);
  ring_.node(id);
  ring_.at(ring_.now() + period, [this, id, period, reading = cpus_[id].reading] {
    if (cpus_[id].reading == reading) read_one_and_wait(id, period);
  });
}

// Its process is gone. It is started again later, unless something else happens to it first.
void Cpus::end(NodeId id, wire::CpuState state, core::Duration later, void (Cpus::*next)(NodeId)) {
  Cpu& cpu = cpus_[id];
  ++cpu.generation;
  cpu.running = cpu.booted = false;
  cpu.boots_later = true;
  read(id, true);
  ring_.reset_cpu(id);
  ring_.set_cpu_present(id, false);
  tell(id, state);
  ring_.at(ring_.now() + later, [this, id, next, epoch = ++cpu.epoch] {
    if (cpus_[id].epoch == epoch) (this->*next)(id);
  });
}

void Cpus::reset(NodeId id) { end(id, wire::CpuState::booting, boot_time_, &Cpus::boot); }

void Cpus::crash(NodeId id) {
  if (!has_crashed(id)) end(id, wire::CpuState::failed, kBackOff, &Cpus::reset);
}

// As in the daemon, a boot counts from the CPU's first message.
void Cpus::boot(NodeId id) {
  ++cpus_[id].boots;
  cpus_[id].booted = true;
  cpus_[id].boots_later = false;
  ring_.set_cpu_present(id, true);
  run(id);
}

void Cpus::started(NodeId id) {
  cpus_[id].boots = 0;
  reset(id);
}

watchdog::CpuSighting Cpus::sighting_of(NodeId id) const {
  const Cpu& cpu = cpus_[id];
  const core::Duration silent = cpu.running ? core::Duration{0} : ring_.now() - cpu.spoke_at;
  return {ring_.now(), cpu.boots, cpu.state, std::chrono::duration_cast<std::chrono::milliseconds>(silent), true};
}

}  // namespace limb_ring::scenario
