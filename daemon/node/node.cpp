#include "node/node.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "config/core_settings.h"
#include "io/packet_loop.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/packet_type.h"
#include "limb_ring/payload/sensor_reading.h"
#include "node/engine.h"
#include "node/observers.h"
#include "node/realtime.h"
#include "node/requests.h"
#include "node/session.h"

namespace limb_ring::runtime {

std::optional<std::string> ClientCalls::on_attach(const host::ClientInfo& client) {
  return client.role == Role::cpu ? to_.cpu.attach(client) : std::nullopt;
}

void ClientCalls::on_detach(const host::ClientInfo& client) {
  to_.driver.controller().apply(core::input::Cancel{SendOwner::of(client.id).to_core()}, to_.driver.now());
  to_.observers.remove(client.id);
  to_.packet_observers.remove(client.id);
  to_.promise_observers.remove(client.id);
  if (client.role == Role::cpu) to_.cpu.detach(client);
  to_.driver.pump();
}

// One truth for the node's status, its beacons and whoever reads the joint states, whichever of the two the CPU uses.
void ClientCalls::hear(const client::SendRequest& request) {
  using payload::PacketType;
  if (request.channel != payload::kJointChannel) return;
  const payload::ByteView data{request.data.data, request.data.size};
  if (payload::is_type(data, PacketType::joint_state)) {
    const auto state = payload::decode_joint_state(data);
    if (state) to_.cpu.stop_latched(state->mode.stopped);
    to_.cpu.watch().sent(state, to_.driver.now());
  } else if (payload::is_type(data, PacketType::imu) || payload::is_type(data, PacketType::force)) {
    to_.cpu.watch().sent(payload::decode_sensor_reading(data), request.destination, to_.driver.now());
  }
}

namespace {

/// Rejected, not kept waiting: who sends as the last one ends must neither stand still nor spin.
Result discarded(std::uint32_t token) {
  Result result;
  result.token = token;
  result.why = Reason::no_way_out;
  result.reason = "the CPU is mute, a fault on purpose";
  return result;
}

}  // namespace

void ClientCalls::on_send(host::ClientId client, const client::SendRequest& request) {
  if (is_cpu(client) && to_.cpu.send_gate().discards()) return to_.host.result(client, discarded(request.token));
  if (is_cpu(client)) hear(request);
  core::SendRequest send;
  send.owner = SendOwner::of(client).to_core();
  send.token = request.token;
  send.destination = wire::NodeId{request.destination};
  send.priority = wire::Priority{request.priority};
  send.channel = wire::ChannelId{request.channel};
  send.data = request.data;
  to_.driver.controller().apply(core::input::Send{send}, to_.driver.now());
  to_.driver.pump_soon();
}

void ClientCalls::on_interrupt(host::ClientId client, const client::InterruptRequest& request) {
  if (is_cpu(client) && to_.cpu.send_gate().discards()) return to_.host.result(client, discarded(request.token));
  const bool to_all = request.destination == wire::kBroadcast;
  if (to_all && !request.force && config::ring_has_reset_on(to_.ring, request.factor)) {
    Result result;
    result.token = request.token;
    result.why = Reason::needs_force;
    result.reason = "factor " + std::to_string(request.factor) + " is wired to reset: " + sentence(result.why);
    return to_.host.result(client, result);
  }
  const core::InterruptRequest interrupt{SendOwner::of(client).to_core(), request.token,
                                         wire::NodeId{request.destination}, wire::Factor{request.factor}};
  to_.driver.pump_around(
      [&](core::Time now) { to_.driver.controller().apply(core::input::Interrupt{interrupt}, now); });
}

void ClientCalls::on_pull(host::ClientId client, const client::PullRequest& request) {
  to_.driver.pump_around([&](core::Time now) {
    to_.driver.controller().apply(core::input::Pull{SendOwner::of(client).to_core(), request.token, request.input},
                                  now);
  });
}

void ClientCalls::on_request(host::ClientId client, const client::JsonRequest& request) {
  to_.requests.handle(std::string(request.json), is_cpu(client),
                      [this, client, token = request.token](const nlohmann::json& answer) {
                        to_.host.reply(client, token, text_of(answer));
                      });
}

bool ClientCalls::changes_something(const client::JsonRequest& request) const {
  return Requests::changes_something(std::string(request.json));
}

void ClientCalls::on_observe(host::ClientId client, const client::ObserveRequest& request) {
  try {
    const ObserveFilter filter = read_observe_filter(to_.ring, std::string(request.json));
    to_.promise_observers.set(client, filter.promises);  // first: it may fail, and nothing is changed then
    to_.observers.set(client, filter.kinds);
    to_.packet_observers.set(client, filter.packets);
  } catch (const std::exception& error) {
    to_.host.observed(client, text_of({{"error", error.what()}}));
  }
}

void ClientCalls::on_shortage(const std::string& why) {
  spdlog::warn("no more tools or CPUs can connect: {} (ulimit -n); trying again", why);
}

void ClientCalls::on_alive(host::ClientId client) {
  if (is_cpu(client)) to_.cpu.spoke();
}

void ClientCalls::on_credit(host::ClientId) { to_.cpu.hand_over(); }

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
