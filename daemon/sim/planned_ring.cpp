#include "sim/planned_ring.h"

#include <algorithm>

#include "config/core_settings.h"
#include "sim/trace.h"

namespace limb_ring::sim {
namespace {

using config::RingConfig;
using wire::NodeId;

NodeId place_of(const RingConfig& ring, NodeId id) {
  return static_cast<NodeId>(setup::index_of(ring, *ring.find(id)));
}

void adjust(const RingConfig& ring, core::Settings& settings) {
  const core::Settings given = settings;
  settings = setup::core_settings(ring, ring.nodes[given.id], given.boot);
  settings.id = given.id;
  settings.order = given.order;
  for (auto& input : settings.inputs)
    if (input && input->destination != wire::kBroadcast) input->destination = place_of(ring, input->destination);
}

}  // namespace

std::unique_ptr<WatchedRing> planned_ring(const RingConfig& ring, const std::vector<int>& drifts) {
  VirtualRingOptions options;
  options.nodes = static_cast<unsigned>(ring.nodes.size());
  options.keep_logs = false;
  options.adjust = [&ring](core::Settings& settings) { adjust(ring, settings); };
  if (!drifts.empty()) options.drift = [drifts](NodeId place) { return drifts[place]; };
  return std::make_unique<WatchedRing>(options);
}

bool assumes_lines(const RingConfig& ring) {
  return std::any_of(ring.nodes.begin(), ring.nodes.end(), [](const auto& node) { return node.link.rate == 0; });
}

RingConfig with_assumed_lines(RingConfig ring, std::uint64_t rate, std::chrono::nanoseconds delay) {
  for (config::NodeConfig& node : ring.nodes) {
    if (node.link.rate != 0) continue;
    node.link.rate = rate;
    node.link.delay = delay;
  }
  return ring;
}

namespace {

std::chrono::nanoseconds in_ns(core::Time time) { return core::whole_nanoseconds(time.time_since_epoch()); }

std::string words(const core::StateChanged& change) {
  return std::string(to_string(change.before)) + " -> " + to_string(change.after);
}
std::string words(const core::PinPulled& pin) {
  return "pin " + std::to_string(pin.factor) + " pulled by node " + std::to_string(pin.source);
}
template <typename Other>
std::string words(const Other&) {
  return {};  // of packets, which are there themselves
}

}  // namespace

capture::RingNames plain_names(unsigned nodes) {
  capture::RingNames names{"plain", {}};
  for (unsigned id = 0; id < nodes; ++id) names.nodes[static_cast<wire::NodeId>(id)] = "node" + std::to_string(id);
  return names;
}

capture::RingNames names_of(const config::RingConfig& ring) {
  capture::RingNames names{ring.ring, {}};
  for (const config::NodeConfig& node : ring.nodes) names.nodes.emplace(wire::NodeId{node.id}, node.name);
  return names;
}

RingCapture::RingCapture(VirtualRing& ring, std::ostream& out, capture::RingNames names, CaptureAt at)
    : ring_(ring), writer_(out, std::move(names)) {
  const auto written = [this](const capture::PacketView& packet) { write(packet); };
  inputs_.assign(ring.size(), capture::PacketAssembler(written));
  if (at == CaptureAt::inputs_and_outputs) outputs_.assign(ring.size(), capture::PacketAssembler(written));
  ring.add_observer(*this);
}

wire::NodeId RingCapture::upstream(wire::NodeId node) const {
  unsigned from = node;
  do from = (from + ring_.size() - 1) % ring_.size();
  while (from != node && !ring_.alive(static_cast<wire::NodeId>(from)));
  return static_cast<wire::NodeId>(from);
}

wire::NodeId RingCapture::downstream(wire::NodeId node) const {
  unsigned to = node;
  do to = (to + 1) % ring_.size();
  while (to != node && !ring_.alive(static_cast<wire::NodeId>(to)));
  return static_cast<wire::NodeId>(to);
}

void RingCapture::write(const capture::PacketView& packet) {
  writer_.packet(packet.at.count(), packet.info, packet.bytes);
}

void RingCapture::leaves(wire::NodeId node, const wire::Slice& slice, core::Time now) {
  if (outputs_.empty()) return;
  outputs_[node].set_line(false, node, downstream(node));
  outputs_[node].put(slice, in_ns(now));
}

void RingCapture::arrives(wire::NodeId node, const wire::Slice& slice, core::Time now) {
  inputs_[node].set_line(true, upstream(node), node);
  inputs_[node].put(slice, in_ns(now));
}

void RingCapture::event(wire::NodeId node, const core::Event& event) {
  const std::string what = std::visit([](const auto& kind) { return words(kind); }, event.what);
  if (!what.empty()) writer_.event(in_ns(event.at).count(), node, what);
}

void RingCapture::incident(wire::NodeId node, Incident incident, core::Time now, core::Line) {
  writer_.event(in_ns(now).count(), node, to_string(incident));
}

}  // namespace limb_ring::sim
