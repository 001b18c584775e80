#include "sim/scenario_supervisor.h"

#include <algorithm>

#include "config/core_settings.h"

namespace limb_ring::scenario {

namespace {

NodeId supervisor_place(const config::RingConfig& config) {
  if (!config.supervisor.node) return NodeId{0};
  return static_cast<NodeId>(setup::index_of(config, *config.find(*config.supervisor.node)));
}

}  // namespace

Supervisor::Supervisor(const config::RingConfig& config, sim::VirtualRing& ring, const Cpus& cpus)
    : config_(config),
      ring_(ring),
      cpus_(cpus),
      beacon_(config.timeouts.beacon),
      node_(supervisor_place(config)),
      membership_(&ring.node(node_).membership()),
      watchdog_(fresh()) {}

watchdog::Watchdog Supervisor::fresh() const {
  std::vector<wire::NodeId> watched;
  for (std::size_t place = 0; place < config_.nodes.size(); ++place)
    if (config::first_pin(config_.nodes[place], config::PinConfig::Action::reset))
      watched.push_back(static_cast<NodeId>(place));
  return {config_.supervisor, wire::kMissedBeacons * beacon_, watched};
}

void Supervisor::start() {
  if (config_.supervisor.policy == config::SupervisorConfig::Policy::automatic) evaluate_later();
}

void Supervisor::started(NodeId id) {
  if (id != node_) return;
  membership_ = &ring_.node(id).membership();
  watchdog_ = fresh();
  resets_.clear();
}

void Supervisor::evaluate_later() {
  ring_.at(ring_.now() + beacon_, [this] {
    if (ring_.alive(node_)) evaluate();
    evaluate_later();
  });
}

void Supervisor::evaluate() {
  const watchdog::Watchdog::Round round =
      watchdog_.evaluate([this](NodeId id) { return sighting_of(id); }, ring_.now());
  for (const NodeId id : round.resets) reset(id);
}

void Supervisor::reset(NodeId id) {
  const std::uint32_t token =
      ring_.interrupt(node_, id, *config::first_pin(config_.nodes[id], config::PinConfig::Action::reset));
  resets_.push_back({id, token, watchdog::ResetOrder(cpu_of(id), ring_.now())});
  ring_.at(ring_.now() + core::Duration(watchdog_.confirm_within()), [this, token] {
    const auto late =
        std::find_if(resets_.begin(), resets_.end(), [token](const Reset& each) { return each.token == token; });
    if (late != resets_.end()) finish(late, late->order.timed_out(ring_.now()));
  });
}

void Supervisor::came(const core::Event& event, NodeId at) {
  if (at != node_) return;
  const auto* ended = std::get_if<core::SendEnded>(&event.what);
  const auto* changed = std::get_if<core::PeerChanged>(&event.what);
  for (auto it = resets_.begin(); it != resets_.end();) {
    const auto place = it++;
    if (ended && ended->token == place->token)
      finish(place, place->order.interrupt_ended(*ended, cpu_of(place->node), event.at));
    else if (changed && changed->node == place->node)
      finish(place, place->order.cpu_changed(cpu_of(place->node), event.at));
  }
}

void Supervisor::finish(std::list<Reset>::iterator reset, const watchdog::ResetOrder::Report& report) {
  if (!report) return;
  const NodeId node = reset->node;
  resets_.erase(reset);
  watchdog_.reset_ended(node, report->success(), report->message, ring_.now());
}

watchdog::CpuSighting Supervisor::sighting_of(NodeId id) const {
  if (id == node_) return cpus_.sighting_of(id);
  return watchdog::sighting_of(membership_->peers()[id]);
}

watchdog::CpuKnown Supervisor::cpu_of(NodeId id) const {
  const watchdog::CpuSighting cpu = sighting_of(id);
  return watchdog::known_of(cpu, watchdog::is_heard(cpu, ring_.now(), beacon_),
                            watchdog::reach_of(ring_.settings(node_).order, membership_->broken_line(), node_, id));
}

}  // namespace limb_ring::scenario
