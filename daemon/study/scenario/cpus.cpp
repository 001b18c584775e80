#include "study/scenario/cpus.h"

namespace limb_ring::study::scenario {

namespace {

/// From a reset to the first word of the firmware. (ours)
constexpr std::chrono::milliseconds kBooting{20};

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

void Cpus::hang(NodeId id) {
  cpus_[id].running = false;
  ring_.cpu_reads[id] = false;
  tell(id, wire::CpuState::silent);
}

void Cpus::resume(NodeId id) {
  cpus_[id].running = true;
  ring_.cpu_reads[id] = true;
  tell(id, wire::CpuState::running);
}

void Cpus::reset(NodeId id) {
  Cpu& cpu = cpus_[id];
  ++cpu.boots;
  cpu.running = false;
  ring_.cpu_reads[id] = true;
  ring_.reset_cpu(id);
  ring_.node(id).set_cpu_present(false);
  tell(id, wire::CpuState::booting);
  ring_.at(ring_.now() + kBooting, [this, id, epoch = ++cpu.epoch] {
    if (cpus_[id].epoch != epoch) return;
    ring_.node(id).set_cpu_present(true);
    resume(id);
  });
}

void Cpus::started(NodeId id) {
  cpus_[id] = {1, true, cpus_[id].epoch + 1};
  resume(id);
}

}  // namespace limb_ring::study::scenario
