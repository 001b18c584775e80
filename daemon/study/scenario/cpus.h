#pragma once

#include <vector>

#include "sim/virtual_ring.h"
#include "study/scenario/scenario.h"

namespace limb_ring::study::scenario {

/// The CPUs of a virtual ring: what runs, hangs, reads nothing or boots, and what their network controllers
/// know of it. A hang is known at once; the daemon waits for the CPU's `alive_period`.
class Cpus {
 public:
  /// All run. @param ring not yet started; must outlive this
  explicit Cpus(sim::VirtualRing& ring);
  Cpus(const Cpus&) = delete;
  Cpus& operator=(const Cpus&) = delete;

  /// It asks its network controller for what it has to send.
  bool sends(NodeId id) const { return ring_.alive(id) && cpus_[id].running; }

  void hang(NodeId id);
  void resume(NodeId id);
  void stop_reading(NodeId id) { ring_.cpu_reads[id] = false; }
  /// As its reset pin does: everything for and from it is thrown away, and it boots.
  void reset(NodeId id);
  /// Its node has come up: a first boot, done.
  void started(NodeId id);

 private:
  struct Cpu {
    std::uint32_t boots = 1;
    bool running = true;
    std::uint64_t epoch = 0;  ///< an end of booting of an earlier life is none of this one
  };
  void tell(NodeId id, wire::CpuState state);

  sim::VirtualRing& ring_;
  std::vector<Cpu> cpus_;
};

}  // namespace limb_ring::study::scenario
