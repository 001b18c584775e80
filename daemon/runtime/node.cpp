#include "runtime/node.h"

#include <unistd.h>

#include "runtime/re_exec.h"
#include "setup/core_settings.h"

namespace limb_ring::runtime {
namespace {

/// As they are before the daemon pins itself: neither its CPU nor a restarted daemon is to share that.
std::optional<cpu_set_t> own_cores(const config::RingConfig& ring) {
  cpu_set_t cores;
  const bool pinned = ring.realtime.auto_cores || !ring.realtime.cores.empty();
  if (!pinned || ::sched_getaffinity(0, sizeof cores, &cores) != 0) return std::nullopt;
  return cores;
}

CpuOptions cpu_options(const config::RingConfig& ring, const config::NodeConfig& node,
                       const std::optional<cpu_set_t>& cores) {
  CpuOptions options;
  options.cpu = node.cpu;
  options.environment = {
      {"LIMB_RING_RING", ring.ring}, {"LIMB_RING_NODE", std::to_string(node.id)}, {"LIMB_RING_CONFIG", ring.path}};
  options.boot_timeout = ring.timeouts.cpu_boot;
  if (!ring.realtime.auto_cores) options.affinity = cores;  // else it stays beside its controller
  return options;
}

fault::RingNodes fault_nodes(const config::RingConfig& ring) {
  fault::RingNodes nodes;
  for (const auto& node : ring.nodes) nodes.push_back({node.name, std::to_string(node.id), wire::NodeId{node.id}});
  return nodes;
}

host::HostOptions host_options(const config::RingConfig& ring, const config::NodeConfig& node,
                               const std::string& directory) {
  return {directory, ring.ring, node.id, node.name, ring.limits.clients};
}

}  // namespace

Node::Node(boost::asio::io_context& io, const config::RingConfig& ring, const config::NodeConfig& config)
    : cores_(own_cores(ring)),
      folder_(ring, config),
      router_({config, reasons_, engine_, host_, folder_, cpu_, pins_, traffic_, interrupts_, faults_, round_trips_,
               observers_}),
      calls_({ring, engine_, host_, cpu_, requests_, observers_, packet_observers_}),
      engine_(io, setup::core_settings(ring, config, folder_.first_boot()),
              setup::link_settings(ring, config, folder_.path()), router_),
      host_(io, host_options(ring, config, folder_.path()), calls_),
      observers_(host_),
      packet_observers_(wire::NodeId{config.id}, engine_, host_),
      cpu_(io, cpu_options(ring, config, cores_), engine_, host_, [this] { router_.on_cpu_changed(); }),
      pins_(config.pins, cpu_),
      traffic_(io, engine_),
      sightings_(ring, config, engine_, cpu_),
      reasons_(ring, config, cpu_, engine_),
      interrupts_(io, engine_, sightings_),
      faults_(io, fault_nodes(ring), engine_, cpu_),
      requests_({ring,
                 config,
                 engine_,
                 cpu_,
                 pins_,
                 traffic_,
                 interrupts_,
                 reasons_,
                 {ring, config, engine_, faults_, [this] { power_cycle(); }},
                 {ring, config, engine_, cpu_, host_, faults_, round_trips_, supervisor_}}),
      folder_watch_(io, folder_to_watch()) {
  if (config::supervisor_of(ring).id == config.id)
    supervisor_.emplace(io, ring, engine_.clock(), interrupts_, sightings_,
                        [this](const Watchdog::Finding& finding) { router_.on_finding(finding); });
}

void Node::start() {
  cpu_.start();
  folder_watch_.start();
  if (supervisor_) supervisor_->start();
}

void Node::stop(std::function<void()> done) {
  folder_watch_.stop();
  if (supervisor_) supervisor_->stop();
  traffic_.stop();
  interrupts_.stop();
  faults_.stop();
  engine_.close();
  host_.close();
  cpu_.stop(std::move(done));
}

void Node::power_cycle() {
  faults_.stop();
  cpu_.kill();
  re_exec(cores_);
}

FolderWatch::Folder Node::folder_to_watch() {
  return {[this] { return folder_.is_in_place() && host_.is_in_place(); },
          [this] {
            folder_.make_again();
            engine_.listen_again();
            host_.listen_again();
          },
          [this] {
            cpu_.kill();
            ::_exit(1);  // nothing is tidied up: the files of these names are the other daemon's
          }};
}

}  // namespace limb_ring::runtime
