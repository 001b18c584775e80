#include "sim/ring_stage.h"

#include <algorithm>

#include "config/quantity.h"

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
  return Failure{std::string("the ring's promise: ") + sim::to_string(violation->promise), with_names(violation->what)};
}

// Whoever judges the virtual ring knows its ids alone: "node 5" there may be "node 6 (left_knee)" of the ring's file.
std::string RingStage::with_names(const std::string& what) const {
  const std::string mark = "node ";
  std::string text;
  std::size_t done = 0;
  for (std::size_t at = what.find(mark); at != std::string::npos; at = what.find(mark, at)) {
    at += mark.size();
    const std::size_t end = std::min(what.find_first_not_of("0123456789", at), what.size());
    const auto id = config::parse_integer(what.substr(at, end - at));
    if (!id || *id > wire::kBroadcast || place_of(static_cast<NodeId>(*id)) >= size()) continue;
    const config::NodeConfig& node = scenario_.ring.nodes[place_of(static_cast<NodeId>(*id))];
    text += what.substr(done, at - done) + std::to_string(node.id) + " (" + node.name + ")";
    done = at = end;
  }
  return text + what.substr(done);
}

}  // namespace limb_ring::scenario
