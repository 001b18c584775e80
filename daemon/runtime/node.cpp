#include "runtime/node.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "limb_ring/ring_directory.h"
#include "runtime/re_exec.h"
#include "runtime/owners.h"
#include "setup/core_settings.h"

namespace limb_ring::runtime {
namespace {

static_assert(static_cast<int>(core::Outcome::cancelled) == static_cast<int>(Outcome::cancelled) &&
                  static_cast<int>(core::Outcome::lost) == static_cast<int>(Outcome::lost),
              "core and client library count outcomes alike");

/// Of the wall clock.
std::uint64_t nanoseconds_since_1970() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                        std::chrono::system_clock::now().time_since_epoch())
                                        .count());
}

/// As they are before the daemon pins itself, which its CPU and its next life are not to share.
std::optional<cpu_set_t> own_cores(const config::RingConfig& ring) {
  cpu_set_t cores;
  if (ring.realtime.cores.empty() || ::sched_getaffinity(0, sizeof cores, &cores) != 0) return std::nullopt;
  return cores;
}

CpuOptions cpu_options(const config::RingConfig& ring, const config::NodeConfig& node,
                       const std::optional<cpu_set_t>& cores) {
  CpuOptions options;
  options.cpu = node.cpu;
  options.environment = {
      {"LIMB_RING_RING", ring.ring}, {"LIMB_RING_NODE", std::to_string(node.id)}, {"LIMB_RING_CONFIG", ring.path}};
  options.boot_timeout = ring.timeouts.cpu_boot;
  options.affinity = cores;
  return options;
}

fault::RingNodes fault_nodes(const config::RingConfig& ring) {
  fault::RingNodes nodes;
  for (const auto& node : ring.nodes) nodes.push_back({node.name, std::to_string(node.id), node.id});
  return nodes;
}

host::HostOptions host_options(const config::RingConfig& ring, const config::NodeConfig& node,
                               const std::string& directory) {
  return {directory, ring.ring, node.id, node.name, ring.limits.clients};
}

std::int64_t clock_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Node::Node(boost::asio::io_context& io, const config::RingConfig& ring, const config::NodeConfig& config)
    : ring_(ring),
      config_(config),
      cores_(own_cores(ring)),
      directory_(make_ring_directory(ring.ring)),
      lock_(std::in_place, directory_, ring.ring, config.id, config.name),
      boots_(std::in_place, directory_, config.id),
      engine_(io, setup::core_settings(ring, config, boots_->first(nanoseconds_since_1970())), link_settings(ring, config, directory_), *this),
      host_(io, host_options(ring, config, directory_), *this),
      observers_(host_),
      packet_observers_(config.id, engine_, host_),
      cpu_(io, cpu_options(ring, config, cores_), engine_, host_, [this] { cpu_changed(); }),
      pins_(config.pins, cpu_),
      traffic_(io, engine_),
      interrupts_(io, engine_, [this](wire::NodeId node) { return cpu_of(node); }),
      faults_(io, fault_nodes(ring), engine_, cpu_),
      folder_(io, folder()),
      requests_(*this) {
  if (config::supervisor_of(ring).id == config.id)
    supervisor_.emplace(io, ring, engine_.clock(), interrupts_, [this](wire::NodeId node) { return sighting_of(node); },
                        [this](const Watchdog::Finding& finding) { found(finding); });
}

void Node::start() {
  cpu_.start();
  folder_.start();
  if (supervisor_) supervisor_->start();
}

void Node::stop(std::function<void()> done) {
  folder_.stop();
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

FolderWatch::Folder Node::folder() {
  return {[this] { return lock_ && lock_->is_in_place() && host_.is_in_place(); }, [this] { make_folder_again(); },
          [this] {
            cpu_.kill();
            ::_exit(1);  // nothing is tidied up: the files of these names are the other daemon's
          }};
}

void Node::make_folder_again() {
  make_ring_directory(ring_.ring);
  if (!lock_ || !lock_->is_in_place()) lock_.emplace(directory_, ring_.ring, config_.id, config_.name);
  boots_.emplace(directory_, config_.id);
  engine_.listen_again();
  host_.listen_again();
}

const config::NodeConfig& Node::next() const {
  return ring_.nodes[(setup::index_of(ring_, config_) + 1) % ring_.nodes.size()];
}

// ---- from the network controller ----------------------------------------------------------

void Node::on_event(const core::Event& event) {
  std::visit([this](const auto& what) { handle(what); }, event.what);
}

void Node::on_round_end() {
  boots_->note(engine_.controller().membership().boot());
  if (engine_.controller().received_waiting() != 0) cpu_.hand_over();
  if (observers_.any()) change_notifier_.look(engine_, observers_);
}

void Node::on_link(std::string_view what) {
  spdlog::info("{}", what);
  observers_.tell("link", {{"what", std::string(what)}});
}

void Node::handle(const core::SendEnded& ended) {
  if (ended.outcome == core::Outcome::delivered) round_trips_.add(ended.round_trip);
  if (ended.owner == kTrafficOwner) return traffic_.on_ended(ended, why(ended).text);
  if (ended.owner == kOrdersOwner) return interrupts_.on_ended(ended);
  if (ended.owner == kBabbleOwner) return faults_.on_ended(ended);
  const auto round_trip = std::chrono::duration_cast<std::chrono::nanoseconds>(ended.round_trip);
  const SendReason reason = why(ended);
  host_.result(ended.owner, {ended.token, static_cast<Outcome>(ended.outcome), round_trip, ended.tries, reason.text,
                             reason.reason});
  if (observers_.any())
    observers_.tell("sent", {{"outcome", to_string(static_cast<Outcome>(ended.outcome))},
                             {"reason_code", to_string(reason.reason)},
                             {"reason", reason.text},
                             {"interrupt", ended.interrupt},
                             {"tries", ended.tries},
                             {"round_trip_us", static_cast<double>(round_trip.count()) / 1000}});
}

void Node::handle(const core::PinPulled& pin) {
  const std::string done = pins_.pull(pin.factor, pin.source, clock_ns());
  spdlog::info("{}", done);
  observers_.tell("pin", {{"factor", std::uint8_t{pin.factor}}, {"source", pin.source}, {"what", done}});
}

void Node::handle(const core::StateChanged& change) {
  if (change.after == core::NodeState::open_chain || change.after == core::NodeState::folded)
    broken_since_ = engine_.now();
  const auto& membership = engine_.controller().membership();
  spdlog::info("{} -> {}, ring size {}", to_string(change.before), to_string(change.after), membership.ring_size());
  const auto line = membership.broken_line();
  nlohmann::json broken;
  if (line) broken = {{"before", line->before}, {"behind", line->behind}};
  observers_.tell("state", {{"before", to_string(change.before)},
                            {"after", to_string(change.after)},
                            {"broken_line", broken},
                            {"ring_size", membership.ring_size()}});
}

void Node::handle(const core::PeerChanged& peer) { interrupts_.on_cpu_changed(peer.node); }

void Node::handle(const core::BeaconHome& beacon) { round_trips_.add(beacon.round_trip); }

// ---- from the host port -------------------------------------------------------------------

std::optional<std::string> Node::on_attach(const host::ClientInfo& client) {
  return client.role == Role::cpu ? cpu_.attach(client) : std::nullopt;
}

void Node::on_detach(const host::ClientInfo& client) {
  engine_.controller().cancel(client.id, engine_.now());
  observers_.remove(client.id);
  packet_observers_.remove(client.id);
  if (client.role == Role::cpu) cpu_.detach(client);
  engine_.pump();
}

void Node::on_send(host::ClientId client, std::uint32_t token, std::uint8_t destination, std::uint8_t priority,
                   std::uint8_t channel, wire::ByteView data) {
  engine_.controller().send({client, token, destination, wire::Priority{priority}, wire::ChannelId{channel}, data}, engine_.now());
  engine_.pump();
}

void Node::on_interrupt(host::ClientId client, std::uint32_t token, std::uint8_t destination, std::uint8_t factor,
                        bool force) {
  if (destination == wire::kBroadcast && !force && config::ring_has_reset_on(ring_, factor)) {
    host_.result(client, {token, Outcome::rejected, {}, 0,
                          "factor " + std::to_string(factor) +
                              " is wired to reset: to reset all CPUs at once, force it",
                          Reason::needs_force});
    return;
  }
  engine_.controller().interrupt({client, token, destination, wire::Factor{factor}}, engine_.now());
  engine_.pump();
}

void Node::on_pull(host::ClientId client, std::uint32_t token, std::uint8_t input) {
  engine_.controller().pull(client, token, input, engine_.now());
  engine_.pump();
}

void Node::on_request(host::ClientId client, std::uint32_t token, const std::string& json) {
  const bool of_cpu = host_.cpu() != nullptr && host_.cpu()->id == client;
  requests_.handle(json, of_cpu, [this, client, token](const nlohmann::json& answer) {
    host_.reply(client, token, answer.dump());
  });
}

void Node::on_observe(host::ClientId client, const std::string& json) {
  try {
    const ObserveFilter order = read_observe_filter(ring_, json);
    observers_.set(client, order.kinds);
    change_notifier_ = {};  // whoever comes anew is told what there is
    packet_observers_.set(client, order.packets);
  } catch (const std::exception& error) {
    host_.observed(client, nlohmann::json{{"error", error.what()}}.dump());
  }
}

void Node::on_alive(host::ClientId client) {
  if (host_.cpu() != nullptr && host_.cpu()->id == client) cpu_.spoke();
}

void Node::on_credit(host::ClientId) { cpu_.hand_over(); }

// ---- CPU ----------------------------------------------------------------------------------

void Node::cpu_changed() {
  const CpuStatus status = cpu_.status();
  if (status.pid > 0) spdlog::info("CPU {} (pid {}, boot {})", to_string(status.state), status.pid, status.boots);
  else spdlog::info("CPU {}", to_string(status.state));
  observers_.tell("cpu", {{"state", to_string(status.state)}, {"pid", status.pid}, {"boots", status.boots}});
  interrupts_.on_cpu_changed(config_.id);
  if (status.boots != std::exchange(cpu_boots_, status.boots)) faults_.cpu_booted();
}

void Node::found(const Watchdog::Finding& finding) {
  observers_.tell("watchdog", {{"id", finding.node}, {"verdict", to_string(finding.verdict)}, {"what", finding.what}});
}

SendReason Node::why(const core::SendEnded& ended) const {
  if (ended.outcome == core::Outcome::delivered) return {};
  const auto own_cpu = cpu_.status().state;
  return reason_of(ended, ring_, config_, own_cpu, engine_.controller().membership());
}

CpuSighting Node::sighting_of(wire::NodeId node) const {
  if (node == config_.id) {
    const CpuStatus status = cpu_.status();
    return {engine_.now(), status.boots, status.state, status.silent,
            status.kind != CpuKind::attached || status.restarted_by_owner};
  }
  const core::Peer& peer = engine_.controller().membership().peers()[node];
  const wire::Beacon& beacon = peer.beacon;
  return {peer.beacon_heard ? std::make_optional(peer.heard_at) : std::nullopt, beacon.cpu_boots, beacon.cpu_state,
          std::chrono::milliseconds(beacon.cpu_silent_ms), beacon.cpu_comes_back};
}

watchdog::CpuKnown Node::cpu_of(wire::NodeId node) const {
  const CpuSighting cpu = sighting_of(node);
  const core::Membership& membership = engine_.controller().membership();
  const bool heard =
      cpu.heard_at && engine_.now() - *cpu.heard_at < watchdog::kMissedBeacons * ring_.timeouts.beacon;
  return {cpu.boots, cpu.comes_back, cpu.state == wire::CpuState::absent, heard,
          watchdog::reach_of(engine_.controller().settings().order, membership.broken_line(), config_.id, node)};
}

}  // namespace limb_ring::runtime
