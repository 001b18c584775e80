#include "study/scenario/cpus.h"

namespace limb_ring::study::scenario {

namespace {

/// From a reset to the first word of the firmware. (ours)
constexpr std::chrono::milliseconds kBooting{20};
/// From its death to the next start, as the daemon's default. (ours)
constexpr std::chrono::milliseconds kBackOff{100};

}  // namespace

Cpus::Cpus(sim::VirtualRing& ring) : ring_(ring), cpus_(ring.size()) {
  for (unsigned id = 0; id < ring.size(); ++id) tell(static_cast<NodeId>(id), wire::CpuState::running);
}

void Cpus::tell(NodeId id, wire::CpuState state) {
  core::CpuReport report;
  report.boots = cpus_[id].boots;
  report.state = state;
  report.spoke_at = ring_.now();
  ring_.node(id).set_cpu(report, ring_.now());
}

void Cpus::read(NodeId id, bool reads) {
  ring_.cpu_reads[id] = reads;
  cpus_[id].slow = false;
  ++cpus_[id].reading;
}

void Cpus::hang(NodeId id) {
  cpus_[id].running = false;
  read(id, false);
  tell(id, wire::CpuState::silent);
}

void Cpus::resume(NodeId id) {
  cpus_[id].running = true;
  ++cpus_[id].life;
  read(id, true);
  tell(id, wire::CpuState::running);
}

void Cpus::stop_reading(NodeId id) { read(id, false); }

void Cpus::slow_down(NodeId id, core::Duration period) {
  read(id, false);
  cpus_[id].slow = true;
  read_one_and_wait(id, period);
}

// It may take one from now on, whenever that comes; touched, so that one that lies there is taken at once.
void Cpus::read_one_and_wait(NodeId id, core::Duration period) {
  ring_.cpu_reads[id] = true;
  ring_.node(id);
  ring_.at(ring_.now() + period, [this, id, period, reading = cpus_[id].reading] {
    if (cpus_[id].reading == reading) read_one_and_wait(id, period);
  });
}

void Cpus::reset(NodeId id) {
  Cpu& cpu = cpus_[id];
  ++cpu.boots;
  ++cpu.life;
  cpu.running = false;
  read(id, true);
  ring_.reset_cpu(id);
  ring_.node(id).set_cpu_present(false);
  tell(id, wire::CpuState::booting);
  ring_.at(ring_.now() + kBooting, [this, id, epoch = ++cpu.epoch] {
    if (cpus_[id].epoch != epoch) return;
    ring_.node(id).set_cpu_present(true);
    resume(id);
  });
}

void Cpus::crash(NodeId id) {
  Cpu& cpu = cpus_[id];
  ++cpu.life;
  cpu.running = false;
  read(id, true);
  ring_.reset_cpu(id);
  ring_.node(id).set_cpu_present(false);
  tell(id, wire::CpuState::failed);
  ring_.at(ring_.now() + kBackOff, [this, id, epoch = ++cpu.epoch] {
    if (cpus_[id].epoch == epoch) reset(id);
  });
}

void Cpus::started(NodeId id) {
  Cpu& cpu = cpus_[id];
  cpu.boots = 1;
  ++cpu.epoch;
  resume(id);
}

}  // namespace limb_ring::study::scenario
