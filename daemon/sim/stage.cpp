#include "sim/stage.h"

#include <algorithm>

#include "sim/planned_ring.h"

namespace limb_ring::scenario {

NodeId RingStage::place_of(NodeId id) const {
  const core::RingOrder& order = ring_.order();
  return static_cast<NodeId>(std::find(order.begin(), order.end(), id) - order.begin());
}

std::optional<wire::Beacon> RingStage::heard(NodeId by, NodeId of) const {
  const core::Peer& peer = membership(by).peers()[id_of(of)];
  if (!peer.beacon_heard) return std::nullopt;
  wire::Beacon beacon = peer.beacon;
  beacon.break_before = place_of(beacon.break_before);
  beacon.break_behind = place_of(beacon.break_behind);
  return beacon;
}

std::uint64_t RingStage::counter(NodeId place, const std::string& name) const {
  std::uint64_t count = 0;
  ring_.counters(id_of(place)).each([&](const char* each, const char*, std::uint64_t value) {
    if (name == each) count = value;
  });
  return count;
}

Fault RingStage::in_ring(Fault fault) const {
  for (NodeId& node : fault.nodes) node = id_of(node);
  if (fault.after_packets != 0) fault.of = id_of(fault.of);
  return fault;
}

void RingStage::send(const Send& send) {
  Send own = send;
  for (NodeId& node : own.from) node = id_of(node);
  if (own.to != wire::kBroadcast) own.to = id_of(own.to);
  senders_.begin(own);
}

std::optional<Stage::Failure> RingStage::failure_of(const std::optional<sim::Violation>& violation) const {
  if (!violation) return std::nullopt;
  return Failure{std::string("the ring's promise: ") + sim::to_string(violation->promise),
                 with_names(violation->words)};
}

// Whoever judges the virtual ring knows its ids alone: "node 5" there may be "node 6 (left_knee)" of the ring's file.
std::string RingStage::with_names(const sim::Words& words) const {
  std::string text;
  std::size_t done = 0;
  for (const auto& [at, size, id] : words.mentions()) {
    if (place_of(id) >= this->size()) continue;
    const config::NodeConfig& node = scenario_.ring.nodes[place_of(id)];
    text += words.text().substr(done, at - done) + std::to_string(node.id) + " (" + node.name + ")";
    done = at + size;
  }
  return text + words.text().substr(done);
}

bool ModelStage::run_until(const std::function<bool()>& done, core::Duration until, const std::string&) {
  const core::Time end = at(until);
  if (ring().run_until(done, end - ring().now())) return true;
  ring().run_until(end);
  return done();
}

std::optional<Stage::Failure> ModelStage::apply(const Fault& fault) {
  const fault::Of of = fault::word_of(fault.name).of;
  if (of == fault::Of::line) return lines_.begin(fault), std::nullopt;
  if (fault.name == Name::step_clock) return sim::step_clocks(ring(), fault), std::nullopt;
  // All are off before the first is on again.
  const bool power_cycle = fault.name == Name::power_cycle;
  if (power_cycle)
    for (const NodeId id : fault.nodes) apply_to_node(Name::kill, id);
  for (const NodeId id : fault.nodes) {
    lasting_.begins(fault.name, id);
    of == fault::Of::cpu ? apply_to_cpu(fault, id) : apply_to_node(power_cycle ? Name::start : fault.name, id);
    if (fault.lasts.count() != 0) end_later(fault, id);
  }
  return std::nullopt;
}

void ModelStage::end_later(const Fault& fault, NodeId id) {
  const Name name = fault.name;
  ring().at(ring().now() + core::Duration(fault.lasts), [this, name, id, number = lasting_.number(name, id)] {
    if (lasting_.number(name, id) != number) return;
    fault::word_of(name).of == fault::Of::cpu ? end_at_cpu(name, id) : apply_to_node(Name::thaw, id);
  });
}

fault::Node ModelStage::node(NodeId id) {
  if (ring().alive(id)) return fault::Node::runs;
  return frozen_[id] ? fault::Node::frozen : fault::Node::dead;
}

void ModelStage::apply_to_node(Name fault, NodeId id) {
  const fault::Node before = node(id);
  const auto now = fault::after(fault, before);
  if (!now || *now == before) return;
  frozen_[id] = *now == fault::Node::frozen;
  switch (*now) {
    case fault::Node::dead:
      return ring().kill(id);
    case fault::Node::frozen:
      return ring().freeze(id, fault == Name::suspend);
    case fault::Node::runs:
      if (before == fault::Node::frozen) return ring().thaw(id);
      ring().start(id);
      started(id);
  }
}

void ModelStage::bring_back(NodeId id) {
  apply_to_node(node(id) == fault::Node::frozen ? Name::thaw : Name::start, id);
}

using config::PinConfig;

VirtualStage::VirtualStage(const Scenario& scenario, std::uint64_t seed)
    : VirtualStage(scenario, seed, sim::planned_ring(scenario.ring, scenario.clocks)) {}

VirtualStage::VirtualStage(const Scenario& scenario, std::uint64_t seed, std::unique_ptr<sim::WatchedRing> ring)
    : ModelStage(scenario, *ring, seed),
      ring_(std::move(ring)),
      cpus_(*ring_, scenario.boot_time),
      supervisor_(scenario.ring, *ring_, cpus_) {
  ring_->on_event = [this](NodeId at, const core::Event& event) { came(event, at); };
  ring_->on_packet = [this](NodeId at, const core::ReceivedPacket& packet) {
    if (const auto send = senders().send_of(packet)) senders().taken(*send);
    cpus_.took_packet(at);
  };
  lines().tap_all();
  supervisor_.start();
  for (const NodeId id : scenario.absent) ring_->kill(id);
}

// ---- time ----------------------------------------------------------------------------------

std::optional<Stage::Failure> VirtualStage::begin() {
  const bool joined = ring_->join();
  start_counting();
  if (joined) return std::nullopt;
  return Failure{"every node joins", "not within 10 s"};
}

// ---- actions --------------------------------------------------------------------------------

void VirtualStage::came(const core::Event& event, NodeId at) {
  senders().came(event, at);
  supervisor_.came(event, at);
  const auto* pin = std::get_if<core::PinPulled>(&event.what);
  if (!pin || scenario().ring.nodes[at].pins[pin->factor].action != PinConfig::Action::reset) return;
  ring_->at(ring_->now(), [this, at] { cpus_.reset(at); });
}

void VirtualStage::apply_to_cpu(const Fault& fault, NodeId id) {
  cpus_.begin(fault, id);
  if (fault::word_of(fault.name).to_cpu != fault::ToCpu::babble) return;
  senders().babble(id, fault.every,
                   [this, id, generation = cpus_.generation(id)] { return cpus_.generation(id) != generation; });
}

void VirtualStage::started(NodeId id) {
  cpus_.started(id);
  supervisor_.started(id);
}

}  // namespace limb_ring::scenario
