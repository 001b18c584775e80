#include "config/core_settings.h"

#include <algorithm>

#include "wire/packet.h"

namespace limb_ring::setup {

using config::LinkConfig;
using config::NodeConfig;
using config::RingConfig;

std::size_t index_of(const RingConfig& ring, const NodeConfig& node) {
  std::size_t i = 0;
  while (ring.nodes[i].id != node.id) ++i;
  return i;
}

core::RingOrder order_of(const RingConfig& ring) {
  core::RingOrder order;
  for (const NodeConfig& node : ring.nodes) order.emplace_back(node.id);
  return order;
}

core::Duration byte_time(const LinkConfig& link) {
  constexpr std::uint64_t kPicosecondsPerByte = 8'000'000'000'000;
  return core::Duration{link.rate == 0 ? 0 : static_cast<std::int64_t>(kPicosecondsPerByte / link.rate)};
}

namespace {

const NodeConfig& successor_of(const RingConfig& ring, const NodeConfig& node) {
  return ring.nodes[(index_of(ring, node) + 1) % ring.nodes.size()];
}

core::Duration all_delays(const RingConfig& ring) {
  core::Duration delays{0};
  for (const NodeConfig& node : ring.nodes) delays += node.link.whole_delay();
  return delays;
}

/// Lines may differ. All packets queue before the slowest one, so a lap is the sum over all nodes of its
/// T and of their d, INTPs cutting in once per node.
core::Duration worst_lap(const RingConfig& ring) {
  core::Duration slowest{0};
  for (const NodeConfig& node : ring.nodes) slowest = std::max(slowest, byte_time(node.link));
  constexpr auto kBytes = static_cast<std::int64_t>(wire::kMaxDataPacketSize + wire::kInterruptPacketSize);
  return slowest * kBytes * static_cast<std::int64_t>(ring.nodes.size()) + all_delays(ring);
}

}  // namespace

unsigned insertion_buffer_needed(const RingConfig& ring, const NodeConfig& node) {
  const bool takes_time = byte_time(successor_of(ring, node).link).count() != 0 || byte_time(node.link).count() != 0;
  return takes_time ? std::max(2u, static_cast<unsigned>(ring.nodes.size())) : 2;
}

std::string too_small_insertion_buffer(const RingConfig& ring, const NodeConfig& node) {
  const unsigned needed = insertion_buffer_needed(ring, node);
  if (ring.limits.insertion_buffer.value_or(needed) >= needed) return "";
  return "limits.insertion_buffer is " + std::to_string(*ring.limits.insertion_buffer) + ": the line into or out of " +
         node.name + " has a data rate, so up to " + std::to_string(needed - 1) +
         " packets of other nodes may wait here, and some may be dropped and sent again; " + std::to_string(needed) +
         " is enough, and is taken if it is not given";
}

core::Settings core_settings(const RingConfig& ring, const NodeConfig& node, std::uint64_t boot) {
  core::Settings s;
  s.id = wire::NodeId{node.id};
  s.order = order_of(ring);
  s.boot = boot;
  s.byte_time_in = byte_time(node.link);
  s.byte_time_out = byte_time(successor_of(ring, node).link);
  s.relay_delay = node.link.whole_delay();  // on a living ring only time-outs use it
  s.lap = worst_lap(ring);
  s.all_delays = all_delays(ring);
  s.insertion_buffer = ring.limits.insertion_buffer.value_or(std::max(8u, insertion_buffer_needed(ring, node)));
  s.interrupt_buffer = ring.limits.interrupt_buffer;
  s.send_queue = ring.limits.send_queue;
  s.receive_buffers = node.receive_buffers.value_or(ring.limits.receive_buffers);
  s.send_timeout_least = ring.timeouts.send;
  s.refused_for = ring.timeouts.refused;
  s.refused_backoff_most = ring.timeouts.refused_backoff;
  s.queue_timeout = ring.timeouts.queue;
  s.stall = ring.timeouts.stall;
  s.beacon = ring.timeouts.beacon;
  s.break_grace = ring.timeouts.break_grace;
  s.fold_permission = ring.timeouts.fold_permission;
  s.fold_back = ring.folds_back();
  s.several_hosts = ring.hosts.size() > 1;
  for (unsigned factor = 0; factor < config::kPins; ++factor) {
    s.wired[factor] = node.pins[factor].action != config::PinConfig::Action::none;
    if (const auto& input = node.inputs[factor])
      s.inputs[factor] = core::InterruptInput{wire::NodeId{input->broadcast ? wire::kBroadcast : input->node},
                                              wire::Factor{input->factor}};
  }
  return s;
}

}  // namespace limb_ring::setup
