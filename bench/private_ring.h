#pragma once

#include <sched.h>
#include <sys/types.h>

#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/measurement.h"
#include "bench/setup.h"
#include "config/ring_config.h"
#include "limb_ring/host_port.h"
#include "ring/launched_ring.h"
#include "ring/ring_client.h"

namespace limb_ring::bench {

struct RingRequest {
  std::string config;     ///< YAML file; empty: a plain ring
  std::string transport;  ///< unix, shm or udp; empty: as the file says
  Pinning pinning = Pinning::free;
  bool record = false;  ///< the flight recorders are on
};

/// A ring of daemons of our own, beside ringctl's other rings; it ends with this object. Its
/// sockets lie in the live::PrivateFolder that is in force.
class PrivateRing {
 public:
  /// Returns when the ring is closed and its child CPUs run.
  /// @throw std::runtime_error if it does not close, with what a daemon said last
  PrivateRing(const Setup& setup, const RingRequest& request);
  ~PrivateRing();
  PrivateRing(const PrivateRing&) = delete;
  PrivateRing& operator=(const PrivateRing&) = delete;

  const std::string& name() const { return config_.ring; }
  const config::RingConfig& config() const { return config_; }
  HostPort connect(std::size_t index, Role role = Role::tool) const;
  /// Of the daemons, and of the CPUs that they started.
  std::vector<pid_t> processes();

 private:
  void wait_until_closed(const Setup& setup);
  std::vector<ask::ToldRow> rows() const;
  void require_running();
  void end();

  config::RingConfig config_;
  live::LaunchedRing daemons_;
};

/// What the kernel alone takes: as many processes in a ring of UNIX stream sockets, each reading
/// what came (up to 64 KiB) and writing it downstream, blocking, with no protocol. The packets are
/// as long as the ring's own. A sender knows its packet by its first byte, times its lap, and lets
/// it go round again. (ours)
/// @throw std::runtime_error if it does not go round
Measurement measure_reference(const Setup& setup, Pinning pinning, Sending sending);

/// Writes the file of a ring of nodes 0, 1, 2 ... @param sections further sections of the file, each ends its line
/// @param attached nodes whose CPU attaches itself; the others have none
/// @return `path`
std::string write_ring(const std::string& path, unsigned nodes, const std::string& sections,
                       const std::set<unsigned>& attached = {});

/// The cores that the processes of a case may use: the last one this process may use itself (the
/// first often serves the machine's interrupts); nothing if they are free.
std::optional<cpu_set_t> cores_for(Pinning pinning);

/// How many cores this process may use.
unsigned core_count();

/// Pins the calling process to these cores; nothing: leaves it free.
void stay_on(const std::optional<cpu_set_t>& cores);

/// What processes take together from here on, in percent of one core.
class CpuShare {
 public:
  /// @throw std::runtime_error if one has ended
  explicit CpuShare(std::vector<pid_t> processes);
  /// Since the beginning. @throw std::runtime_error if one has ended
  double percent() const;

 private:
  std::vector<pid_t> processes_;
  double before_;  ///< s
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

/// What a ring takes that has nothing to do but what its configuration makes it do: percent of one
/// core, all its processes together, daemons and CPUs. If the first node's CPU is attached, one
/// that only reads takes its place (and is not counted).
double measure_idle_percent(const Setup& setup, PrivateRing& ring);

}  // namespace limb_ring::bench
