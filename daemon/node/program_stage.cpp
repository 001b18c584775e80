#include "node/program_stage.h"

#include <algorithm>
#include <csignal>

#include "config/fault.h"
#include "config/quantity.h"
#include "io/program.h"
#include "io/signal_wait.h"
#include "sim/trace.h"

namespace limb_ring::program_stage {

using fault::Name;
using scenario::Fault;
using std::chrono::steady_clock;
using wire::CpuState;
using wire::NodeId;

namespace {

constexpr std::chrono::seconds kToJoin{10};  ///< of the ring's time
constexpr std::chrono::seconds kToEnd{5};    ///< of real time, for all programs

}  // namespace

std::unique_ptr<ProgramStage::Host> ProgramStage::make_host(const config::RingConfig& ring, std::uint64_t seed,
                                                            int cpu_output) {
  virtual_host::VirtualRingHostOptions options;
  options.line_fault_seed = seed;
  options.cpu_output = cpu_output;
  return std::make_unique<Host>(ring, options);
}

ProgramStage::ProgramStage(const scenario::Scenario& scenario, const config::RingConfig& ring, std::uint64_t seed,
                           int cpu_output)
    : ProgramStage(scenario, make_host(ring, seed, cpu_output), seed) {}

ProgramStage::ProgramStage(const scenario::Scenario& scenario, std::unique_ptr<Host> host, std::uint64_t seed)
    : RingStage(scenario, host->host.ring(), seed),
      host_(std::move(host)),
      invariants_(ring()),
      cpus_(ring().size()),
      signals_(host_->io, SIGINT, SIGTERM) {
  if (!process::ignores_hangup()) signals_.add(SIGHUP);
  ring().add_observer(*this);
  host_->host.line_faults().tap_all();
  host_->host.on_cpu_changed = [this](std::uint8_t id, const auto& status) { cpu_changed(NodeId{id}, status); };
  host_->host.lockstep().on_credited = [this](std::uint8_t id, unsigned packets) {
    cpus_[id].taken.credited(packets, [this](std::size_t send) { senders().taken(send); });
  };
  host_->host.lockstep().on_stuck = [this](std::uint8_t id, const std::string& program, bool answers) {
    const std::string name = name_of(NodeId{id});
    const std::string what = answers ? ", lets no time pass" : ", does not answer";
    notes_.push_back(
        {name + ": its CPU, " + program + what, answers ? "cpu_lets_no_time_pass" : "cpu_does_not_answer", name});
  };
  signals_.async_wait([this](const boost::system::error_code& error, int) {
    if (error) return;
    interrupted_ = true;
    host_->io.stop();
  });
}

ProgramStage::~ProgramStage() {
  host_->io.restart();
  signals_.cancel();
  const auto ended = std::make_shared<bool>(false);
  host_->host.stop([ended] { *ended = true; });
  const auto end = steady_clock::now() + kToEnd;
  while (!*ended && steady_clock::now() < end) host_->io.run_one_for(kToEnd);
}

scenario::RunTrace ProgramStage::trace() const {
  return {sim::hash_text(host_->host.trace_hash()), host_->host.not_repeatable()};
}

// ---- time -----------------------------------------------------------------------------------

std::string ProgramStage::first_not_ready() const {
  std::vector<NodeId> there;
  for (unsigned place = 0; place < size(); ++place)
    if (alive(static_cast<NodeId>(place))) there.push_back(static_cast<NodeId>(place));
  for (const NodeId place : there) {
    const runtime::CpuStatus cpu = host_->host.node(id_of(place))->cpu_status();
    if (cpu.state != CpuState::running || cpu.exits + cpu.failed_boots != 0)
      return name(place) + ": its CPU is " + to_string(cpu.state) + (cpu.last_exit.empty() ? "" : ": " + cpu.last_exit);
  }
  for (const NodeId place : there) {
    if (state(place) != core::NodeState::up || ring_size(place) != there.size())
      return name(place) + " is " + to_string(state(place)) + ", in a ring of " + std::to_string(ring_size(place));
    for (const NodeId of : there)
      if (of != place && heard(place, of).value_or(wire::Beacon{}).cpu_boots == 0)
        return name(place) + " has not heard of the CPU of " + name(of);
  }
  return "";
}

std::optional<scenario::Stage::Failure> ProgramStage::begin() {
  start_counting();
  // Before anything happens: they have never been there.
  for (const NodeId place : scenario().absent) {
    Fault kill;
    kill.name = Name::kill;
    kill.nodes = {id_of(place)};
    begin(kill);
  }
  host_->host.start();
  // A program that cannot be started, or does not connect, would be tried again and again.
  const auto has_ended = [](const Cpu& cpu) { return cpu.ends != 0; };
  const auto settled = [&] { return std::any_of(cpus_.begin(), cpus_.end(), has_ended) || first_not_ready().empty(); };
  run_until(settled, kToJoin, "");
  if (const std::string lack = first_not_ready(); !lack.empty())
    return Failure{"every node joins and its CPU runs, within " + std::to_string(kToJoin.count()) + " s", lack};
  // Not in the middle of beacons, which go out together since all have booted at once: what breaks there costs a
  // time-out.
  run_until([] { return false; }, now() + core::Duration(scenario().ring.timeouts.beacon) / 3, "");
  start_counting();
  return std::nullopt;
}

bool ProgramStage::run_until(const std::function<bool()>& done, core::Duration until, const std::string&) {
  const bool is_done = host_->host.run_until(done, at(until));
  throw_if_interrupted();
  return is_done;
}

void ProgramStage::throw_if_interrupted() {
  if (interrupted_) throw Interrupted();
}

// ---- CPUs -----------------------------------------------------------------------------------

void ProgramStage::packet(NodeId node, const core::ReceivedPacket& packet) {
  cpus_[node].taken.given(senders().send_of(packet));
}

void ProgramStage::incident(NodeId node, sim::Incident incident, core::Time, core::Line) {
  if (incident == sim::Incident::killed) cpus_[node] = {};
  if (incident == sim::Incident::cpu_reset) cpus_[node].taken.clear();
  if (incident != sim::Incident::thawed) return;
  for (const Fault& fault : std::exchange(cpus_[node].when_thawed, {}))
    host_->host.at(ring().now(), [this, fault, node] { begin_at_cpu(fault, node); });
}

void ProgramStage::cpu_changed(NodeId id, const runtime::CpuStatus& status) {
  const std::uint64_t ends = status.exits + status.failed_boots;
  if (std::exchange(cpus_[id].ends, ends) == ends) return;
  const std::string name = name_of(id);
  notes_.push_back({name + ": its CPU has ended: " + status.last_exit, "cpu_ended", name});
}

bool ProgramStage::cpu_sends(NodeId id) const {
  const runtime::Node* node = host_->host.node(id);
  if (node == nullptr || !alive(place_of(id))) return false;
  const runtime::CpuStatus cpu = node->cpu_status();
  const bool there = cpu.state == CpuState::running || cpu.state == CpuState::silent;
  return there && !host_->host.lockstep().is_stuck(id) && !node->faults().silence_cpu();
}

// ---- actions --------------------------------------------------------------------------------

std::optional<scenario::Stage::Failure> ProgramStage::apply(const Fault& fault) {
  Fault own = in_ring(fault);
  if (fault::word_of(fault.name).of == fault::Of::line) {
    host_->host.line_faults().begin(own);
    return std::nullopt;
  }
  const auto act = [&] {
    if (fault::word_of(fault.name).of == fault::Of::cpu) {
      for (const NodeId id : own.nodes) begin_at_cpu(own, id);
      return;
    }
    if (fault.name == Name::power_cycle) return power_cycle(own);
    remove_those_so_already(own);
    begin(own);
  };
  host_->host.at(ring().now(), act);
  ring().run_until(ring().now());
  return refused_;
}

/// If it cannot be done, perhaps later, that is the end of the run.
void ProgramStage::begin(const Fault& fault) {
  if (fault.nodes.empty()) return;
  const auto told = [this](const std::string& problem) {
    if (!problem.empty() && !refused_) refused_ = Failure{"the ring does it", problem};
  };
  host_->host.begin(fault, told);
}

/// As with models of CPUs: nothing happens to a CPU that is not there.
void ProgramStage::begin_at_cpu(const Fault& fault, NodeId id) {
  const virtual_host::NodeFaults& nodes = host_->host.node_faults();
  if (nodes.is_dead(id)) return;
  Fault one = fault;
  one.nodes = {id};
  if (nodes.is_frozen(id)) return cpus_[id].when_thawed.push_back(one);
  if (!fault::hits_process(fault.name) || host_->host.node(id)->cpu_status().pid > 0) begin(one);
}

void ProgramStage::remove_those_so_already(Fault& fault) const {
  const virtual_host::NodeFaults& nodes = host_->host.node_faults();
  const auto so_already = [&](NodeId id) { return !fault::after(fault.name, nodes.state(id)); };
  fault.nodes.erase(std::remove_if(fault.nodes.begin(), fault.nodes.end(), so_already), fault.nodes.end());
}

/// All are off before the first is on again, whatever they were before.
void ProgramStage::power_cycle(const Fault& fault) {
  Fault kill = fault, start = fault;
  kill.name = Name::kill;
  remove_those_so_already(kill);
  begin(kill);
  start.name = Name::start;
  begin(start);
}

using config::CpuConfig;
using scenario::Scenario;
using std::chrono::milliseconds;

std::vector<std::string> not_with_programs(const Scenario& scenario) {
  std::vector<std::string> reasons;
  if (scenario.world == scenario::World::soak) reasons.emplace_back("world: soak: its CPUs are not programs");
  if (scenario.boot_time != std::chrono::floor<milliseconds>(scenario.boot_time))
    reasons.push_back("boot_time: " + config::format_time(scenario.boot_time) +
                      ": of real programs it is whole milliseconds");
  if (!scenario.clocks.empty()) reasons.emplace_back("clocks: real programs have the ring's clock");
  return reasons;
}

std::vector<std::string> missing_programs(const config::RingConfig& ring) {
  std::vector<std::string> missing;
  for (const config::NodeConfig& node : ring.nodes)
    if (const std::string& name = node.cpu.command.front(); process::find_program(name).empty())
      missing.push_back(node.name + ": " + process::no_program(name));
  return missing;
}

config::RingConfig ring_with_programs(const Scenario& scenario, const StandIn& stand_in, std::uint64_t seed) {
  config::RingConfig ring = scenario.ring;
  for (config::NodeConfig& node : ring.nodes) {
    if (node.cpu.kind == CpuConfig::Kind::child && !stand_in.everywhere) continue;
    node.cpu = {};
    node.cpu.kind = CpuConfig::Kind::child;
    node.cpu.command = {stand_in.path};
    node.cpu.alive_period = scenario::kAlivePeriod;
  }
  ring.virtual_clock.boot_time = std::chrono::floor<milliseconds>(scenario.boot_time);
  ring.virtual_clock.seed = static_cast<std::uint32_t>(seed);
  return ring;
}

}  // namespace limb_ring::program_stage
