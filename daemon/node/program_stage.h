#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "node/virtual_ring_host.h"
#include "sim/invariants.h"
#include "sim/scenario.h"
#include "sim/scenario_run.h"
#include "sim/stage.h"

namespace limb_ring::program_stage {

/// What a CPU has taken of what its node has given to it. A CPU says so by its credit: the first is what it likes to
/// have, and each packet it has taken is one more. (docs/reference/host_port.md)
class TakenPackets {
 public:
  /// Of a scenario; nothing: a packet of no send.
  using Send = std::optional<std::size_t>;

  void given(Send send) { given_.push_back(send); }
  /// Calls `taken` for each packet of a scenario that has been taken by now.
  template <class Taken>
  void credited(unsigned packets, Taken taken) {
    if (!std::exchange(greeted_, true)) return;
    for (; packets != 0 && !given_.empty(); --packets) {
      if (given_.front()) taken(*given_.front());
      given_.pop_front();
    }
  }
  /// Another CPU takes its place.
  void clear() {
    given_.clear();
    greeted_ = false;
  }

 private:
  std::deque<Send> given_;
  bool greeted_ = false;  ///< the first credit is in
};

/// The user wants no more of it.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

/// A virtual ring with real programs as the CPUs of its nodes, as a stage for scenarios: in lockstep with the programs,
/// seen and judged at every event. What a scenario has a CPU send enters at its node as the program's own sends do, and
/// ends with the program. SIGINT, SIGTERM and (without nohup) SIGHUP end it. (ours)
///
/// begin(), run_until() and apply() may throw Interrupted. All programs have ended when this is destroyed.
class ProgramStage final : public scenario::RingStage, private sim::Observer {
 public:
  /// Its sockets are in the ring's folder, as those of daemons are. Nothing is started before begin().
  /// @param scenario, ring outlive this @param ring as ring_with_programs() has it
  /// @param cpu_output descriptor for what the programs print; not closed
  /// @throw std::exception if a socket cannot be had
  ProgramStage(const scenario::Scenario& scenario, const config::RingConfig& ring, std::uint64_t seed, int cpu_output);
  ~ProgramStage() override;

  std::optional<Failure> begin() override;
  bool run_until(const std::function<bool()>& done, core::Duration until, const std::string& what) override;
  /// The ring's promises, and that it does as it is told.
  std::optional<Failure> broken() const override { return refused_ ? refused_ : failure_of(invariants_.violation()); }
  /// CPUs that do not answer, or have ended by themselves.
  std::vector<scenario::Note> take_notes() override { return std::exchange(notes_, {}); }
  std::optional<Failure> apply(const scenario::Fault& fault) override;

  scenario::RunTrace trace() const;

 private:
  /// The ring, and what it runs in.
  struct Host {
    Host(const config::RingConfig& ring, const virtual_host::VirtualRingHostOptions& options)
        : host(io, ring, options) {}
    boost::asio::io_context io{1};
    virtual_host::VirtualRingHost host;
  };
  struct Cpu {
    TakenPackets taken;
    std::uint64_t ends = 0;                    ///< of its programs by themselves, and boots that failed
    std::vector<scenario::Fault> when_thawed;  ///< its daemon, which would do it, is frozen
  };

  ProgramStage(const scenario::Scenario& scenario, std::unique_ptr<Host> host, std::uint64_t seed);
  static std::unique_ptr<Host> make_host(const config::RingConfig& ring, std::uint64_t seed, int cpu_output);

  void event(wire::NodeId node, const core::Event& event) override { senders().came(event, node); }
  void packet(wire::NodeId node, const core::ReceivedPacket& packet) override;
  void incident(wire::NodeId node, sim::Incident incident, core::Time now, core::Line line) override;

  bool cpu_sends(wire::NodeId id) const override;
  void cpu_changed(wire::NodeId id, const runtime::CpuStatus& status);
  std::string first_not_ready() const;
  void begin(const scenario::Fault& fault);
  void begin_at_cpu(const scenario::Fault& fault, wire::NodeId id);
  void remove_those_so_already(scenario::Fault& fault) const;
  void power_cycle(const scenario::Fault& fault);
  void throw_if_interrupted();
  const std::string& name_of(wire::NodeId id) const { return name(place_of(id)); }

  std::unique_ptr<Host> host_;
  sim::Invariants invariants_;
  std::vector<Cpu> cpus_;  ///< by id
  std::vector<scenario::Note> notes_;
  std::optional<Failure> refused_;  ///< a fault
  boost::asio::signal_set signals_;
  bool interrupted_ = false;
};

/// The program that is the CPU of a node for which the ring's file names none.
struct StandIn {
  std::string path;         ///< of scenario_cpu
  bool everywhere = false;  ///< also in place of those that the file names
};

/// What in a scenario is not possible on a virtual ring with real programs, and why; empty: it can be played there.
std::vector<std::string> not_with_programs(const scenario::Scenario& scenario);

/// Nodes whose program cannot be found, with what the file names: "knee: no program 'x' ..."; empty: all are there.
std::vector<std::string> missing_programs(const config::RingConfig& ring);

/// The scenario's ring with a program as the CPU of every node.
config::RingConfig ring_with_programs(const scenario::Scenario& scenario, const StandIn& stand_in, std::uint64_t seed);

}  // namespace limb_ring::program_stage
