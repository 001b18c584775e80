#pragma once

#include <vector>

#include "config/watchdog.h"
#include "sim/scenario.h"
#include "sim/virtual_ring.h"

namespace limb_ring::scenario {

/// The CPUs of a virtual ring: what runs, hangs, is slow, reads nothing, crashes or boots, and what their network
/// controllers know of it. As in a live scenario each has promised to speak every kAlivePeriod, so a hang is known
/// after three of them.
class Cpus {
 public:
  /// All CPUs run at first. @param ring not yet started; must outlive this
  /// @param boot_time from a reset to the first word of the firmware
  Cpus(sim::VirtualRing& ring, core::Duration boot_time);
  Cpus(const Cpus&) = delete;
  Cpus& operator=(const Cpus&) = delete;

  /// Whether it runs, so that it asks its network controller to send what the scenario says.
  bool sends(NodeId id) const { return ring_.alive(id) && cpus_[id].running; }

  void hang(NodeId id);
  /// Cures it: it no longer hangs, is slow or babbles, and it reads again.
  void resume(NodeId id);
  void stop_reading(NodeId id);
  /// It takes one packet in each `period` from now on.
  void slow_down(NodeId id, core::Duration period);
  /// A CPU has taken a packet.
  void took_packet(NodeId id) {
    if (cpus_[id].slow) ring_.set_cpu_reads(id, false);
  }
  /// It begins to babble and goes on while generation() stays the same: until it is cured or restarted.
  std::uint64_t generation(NodeId id) const { return cpus_[id].generation; }
  /// As its reset pin does: everything for and from it is thrown away, and it boots.
  void reset(NodeId id);
  /// It has crashed, and all packets for and from it are gone. It is started again after the daemon's first back-off.
  void crash(NodeId id);
  /// Its node has come up, and the CPU boots for the first time.
  void started(NodeId id);
  /// As its own network controller sees it.
  watchdog::CpuSighting sighting_of(NodeId id) const;

 private:
  void end(NodeId id, wire::CpuState state, core::Duration later, void (Cpus::*next)(NodeId));
  struct Cpu {
    std::uint32_t boots = 1;
    wire::CpuState state = wire::CpuState::running;
    core::Time spoke_at{};  ///< last; of one that runs, when that began
    bool running = true;
    bool booted = true;
    bool boots_later = false;  ///< it has not booted, and nothing keeps it from that
    bool slow = false;
    std::uint64_t epoch = 0;       ///< counts boots: the end of an earlier one does not count
    std::uint64_t generation = 0;  ///< a new one with each start and each cure
    std::uint64_t reading = 0;     ///< counts changes of how it reads: steps of an earlier slowness do not count
  };
  /// It has no process until its back-off is over.
  bool has_crashed(NodeId id) const { return cpus_[id].state == wire::CpuState::failed; }
  void tell(NodeId id, wire::CpuState state);
  void boot(NodeId id);
  void run(NodeId id);
  void read(NodeId id, bool reads);
  void read_one_and_wait(NodeId id, core::Duration period);

  sim::VirtualRing& ring_;
  core::Duration boot_time_;
  std::vector<Cpu> cpus_;
};

}  // namespace limb_ring::scenario
