#include "node/node.h"

#include <unistd.h>

#include "config/core_settings.h"
#include "io/packet_loop.h"
#include "node/engine.h"
#include "node/realtime.h"

namespace limb_ring::runtime {
namespace {

CpuOptions cpu_options(const config::RingConfig& ring, const config::NodeConfig& node, const NodeBase& base) {
  CpuOptions options;
  options.cpu = node.cpu;
  options.environment = {
      {"LIMB_RING_RING", ring.ring}, {"LIMB_RING_NODE", std::to_string(node.id)}, {"LIMB_RING_CONFIG", ring.path}};
  options.boot_timeout = ring.timeouts.cpu_boot;
  options.affinity = base.cpu_cores;
  options.boots_for = base.cpu_boots_for;
  options.on_signal = base.on_cpu_signal;
  options.output = base.cpu_output;
  options.log_prefix = base.log_prefix;
  return options;
}

host::HostOptions host_options(const config::RingConfig& ring, const config::NodeConfig& node,
                               const std::string& directory, host::TurnKeeper* turns) {
  return {directory, ring.ring, node.id, node.name, ring.limits.clients, turns};
}

}  // namespace

Node::Node(boost::asio::io_context& io, const config::RingConfig& ring, const config::NodeConfig& config,
           const NodeBase& base)
    : folder_(base.folder ? base.folder : std::make_shared<NodeFolder>(ring, config)),
      start_anew_(base.start_anew),
      driver_(base.make_driver(*folder_, router_)),
      router_({config, base.log_prefix, reasons_, *driver_, host_, *folder_, cpu_, pins_, traffic_, interrupts_,
               faults_, round_trips_, observers_, lately_damaged_, neighbours_}),
      calls_({ring, *driver_, host_, cpu_, requests_, observers_, packet_observers_, promise_observers_}),
      filter_(base.make_filter ? base.make_filter(calls_) : nullptr),
      host_(io, host_options(ring, config, folder_->path(), base.turns), filter_ ? *filter_ : calls_),
      observers_(host_, driver_->clock()),
      packet_observers_(wire::NodeId{config.id}, *driver_, host_),
      promise_observers_(wire::NodeId{config.id}, folder_->path(), *driver_, host_),
      cpu_(io, cpu_options(ring, config, base), ring, config, *driver_, host_,
           [this, tell = base.on_cpu_changed] {
             const CpuStatus cpu = cpu_.status();
             if (!cpu.unsettled) router_.on_cpu_changed();
             if (tell) tell(cpu);
           }),
      pins_(config.pins, cpu_),
      traffic_(*driver_),
      sightings_(ring, config, *driver_, cpu_),
      neighbours_(ring, config.id),
      reasons_(ring, config, cpu_, *driver_),
      interrupts_(*driver_, sightings_),
      faults_(io, fault::nodes_by_id(ring), *driver_, cpu_, ring.timeouts.cpu_boot),
      requests_({ring,
                 config,
                 *driver_,
                 cpu_,
                 router_,
                 pins_,
                 traffic_,
                 interrupts_,
                 reasons_,
                 {ring, config, *driver_, faults_, [this] { power_cycle(); }},
                 {ring, config, *driver_, cpu_, host_, faults_, round_trips_, lately_damaged_, neighbours_, supervisor_,
                  base.turns},
                 base.clock}),
      folder_watch_(io, folder_to_watch()) {
  if (config::supervisor_of(ring).id == config.id)
    supervisor_.emplace(ring, *driver_, interrupts_, sightings_,
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
  driver_->close();
  host_.close();
  cpu_.stop(std::move(done));
}

void Node::die() {
  faults_.stop();
  host_.close("");
  cpu_.kill();
}

void Node::power_cycle() {
  faults_.stop();
  cpu_.kill();
  start_anew_();
}

FolderWatch::Folder Node::folder_to_watch() {
  return {folder_->path(),
          [this] {
            return folder_->is_in_place() && driver_->is_in_place() && host_.is_in_place() &&
                   promise_observers_.is_in_place();
          },
          [this] {
            folder_->make_again();
            driver_->listen_again();
            if (!host_.is_in_place()) host_.listen_again();
            promise_observers_.put_back();
          },
          [this] {
            cpu_.kill();
            ::_exit(1);  // nothing is tidied up: the files of these names are the other daemon's
          }};
}

namespace {

/// Where the daemon is to be pinned.
std::optional<cpu_set_t> own_cores(const config::RingConfig& ring) {
  cpu_set_t cores;
  const bool pinned = ring.realtime.auto_cores || !ring.realtime.cores.empty();
  if (!pinned || ::sched_getaffinity(0, sizeof cores, &cores) != 0) return std::nullopt;
  return cores;
}

recorder::Title title_of(const config::RingConfig& ring, const config::NodeConfig& node) {
  recorder::Title title;
  title.ring = ring.ring;
  title.node = node.name;
  return title;
}

}  // namespace

NodeBase daemon_base(boost::asio::io_context& io, const config::RingConfig& ring, const config::NodeConfig& node) {
  const auto cores = own_cores(ring);
  NodeBase base;
  base.make_driver = [&io, &ring, &node](const NodeFolder& folder, DriverListener& listener) {
    auto engine = std::make_unique<Engine>(io, setup::core_settings(ring, node, folder.first_boot()),
                                           setup::link_settings(ring, node, folder.path()), listener);
    if (ring.recorder.enabled)
      engine->record(recorder::recording_of(folder.path(), node.id), ring.recorder.size, title_of(ring, node));
    return engine;
  };
  base.start_anew = [&io, cores] {
    event_loop::PacketLoop::of(io).end_core_sharing();
    re_exec(cores);
  };
  if (!ring.realtime.auto_cores) base.cpu_cores = cores;  // else the CPU stays beside its controller
  return base;
}

}  // namespace limb_ring::runtime
