#include "sim/virtual_ring.h"

#include <algorithm>

namespace limb_ring::sim {

using core::kNever;
using wire::Slice;
using wire::SliceWriter;

VirtualRing::VirtualRing(const VirtualRingOptions& options)
    : cpu_reads(options.nodes, true), options_(options), nodes_(options.nodes) {
  for (unsigned id = 0; id < options.nodes; ++id) {
    nodes_[id].controller = std::make_unique<Controller>(settings_of(static_cast<NodeId>(id)));
    nodes_[id].alive = options.start;
  }
  if (!options.start) return;
  for (unsigned id = 0; id < options.nodes; ++id) {
    node(static_cast<NodeId>(id)).set_cpu_present(true);
    connect(static_cast<NodeId>(id));
  }
}

core::Settings VirtualRing::settings_of(NodeId id) const {
  core::Settings settings;
  settings.id = id;
  settings.order.clear();
  for (unsigned other = 0; other < options_.nodes; ++other) settings.order.push_back(static_cast<NodeId>(other));
  settings.boot = (nodes_[id].lives + 1) << 32 | std::uint64_t{id} << 24;
  settings.byte_time_in = settings.byte_time_out = options_.byte_time;
  settings.relay_delay = options_.relay_delay;
  settings.wired = {true, true, true, false, false, false, false, false};
  options_.adjust(settings);
  return settings;
}

// ---- topology -----------------------------------------------------------------------------

int VirtualRing::next_alive(NodeId id) const {
  for (unsigned i = 1; i <= nodes_.size(); ++i)
    if (nodes_[(id + i) % nodes_.size()].alive) return static_cast<int>((id + i) % nodes_.size());
  return -1;
}

int VirtualRing::previous_alive(NodeId id) const {
  const std::size_t n = nodes_.size();
  for (std::size_t i = 1; i <= n; ++i)
    if (nodes_[(id + n - i) % n].alive) return static_cast<int>((id + n - i) % n);
  return -1;
}

void VirtualRing::disconnect_output(NodeId id) {
  Node& from = nodes_[id];
  if (from.successor < 0) return;
  Node& to = nodes_[from.successor];
  ++from.line_epoch;
  if (from.alive) from.controller->output_lost(now_);
  if (to.alive && to.predecessor == id) {
    to.controller->input_lost(now_);
    to.predecessor = -1;
    touch(static_cast<NodeId>(from.successor));
  }
  from.successor = -1;
  touch(id);
}

void VirtualRing::connect(NodeId id) {
  Node& from = nodes_[id];
  const int next = next_alive(id);
  if (!from.alive || from.wire_cut || next < 0 || next == from.successor) return;
  disconnect_output(id);
  Node& to = nodes_[next];
  if (to.predecessor >= 0 && to.predecessor != id) disconnect_output(static_cast<NodeId>(to.predecessor));
  from.successor = next;
  to.predecessor = id;
  to.controller->input_up(id, now_);
  from.controller->output_up(static_cast<NodeId>(next), now_);
  touch(id);
  touch(static_cast<NodeId>(next));
}

// The neighbours close the ring without this node.
void VirtualRing::leave(NodeId id) {
  const int before = previous_alive(id);
  if (before >= 0 && before != id) disconnect_output(static_cast<NodeId>(before));
  disconnect_output(id);
  nodes_[id].alive = false;
  nodes_[id].predecessor = -1;
  if (before >= 0 && before != id) connect(static_cast<NodeId>(before));
}

// The neighbours close the ring with this node in it.
void VirtualRing::enter(NodeId id) {
  nodes_[id].alive = true;
  nodes_[id].wake = kNever;
  const int before = previous_alive(id);
  if (before != id) connect(static_cast<NodeId>(before));
  connect(id);
}

void VirtualRing::kill(NodeId id) {
  if (alive(id)) leave(id);
}

void VirtualRing::start(NodeId id) {
  if (alive(id)) return;
  Node& n = nodes_[id];
  ++n.lives;
  n.controller = std::make_unique<Controller>(settings_of(id));
  n.controller->set_cpu_present(true);
  enter(id);
}

void VirtualRing::freeze(NodeId id) { kill(id); }

void VirtualRing::thaw(NodeId id) {
  if (alive(id)) return;
  node(id).input_lost(now_);
  node(id).output_lost(now_);
  enter(id);
}

void VirtualRing::cut(NodeId id) {
  Node& from = nodes_[id];
  if (from.wire_cut) return;
  from.wire_cut = true;
  ++from.line_epoch;  // what is under way is gone
  if (from.successor < 0) return;
  nodes_[from.successor].controller->input_lost(now_);
  touch(static_cast<NodeId>(from.successor));
}

void VirtualRing::heal(NodeId id) {
  Node& from = nodes_[id];
  if (!from.wire_cut) return;
  from.wire_cut = false;
  ++from.line_epoch;
  if (from.successor < 0 || from.successor != next_alive(id)) return connect(id);
  nodes_[from.successor].controller->input_up(id, now_);
  touch(static_cast<NodeId>(from.successor));
}

// ---- traffic ------------------------------------------------------------------------------

std::uint32_t VirtualRing::send(NodeId id, NodeId destination, const std::vector<std::uint8_t>& data,
                                std::uint8_t priority, std::uint8_t channel) {
  const std::uint32_t token = nodes_[id].next_token++;
  node(id).send({1, token, destination, priority, channel, {data.data(), data.size()}}, now_);
  touch(id);
  return token;
}

std::uint32_t VirtualRing::interrupt(NodeId id, NodeId destination, std::uint8_t factor) {
  const std::uint32_t token = nodes_[id].next_token++;
  node(id).interrupt({1, token, destination, factor}, now_);
  touch(id);
  return token;
}

std::uint32_t VirtualRing::pull(NodeId id, unsigned input) {
  const std::uint32_t token = nodes_[id].next_token++;
  node(id).pull(1, token, input, now_);
  touch(id);
  return token;
}

const core::SendEnded* VirtualRing::ended(NodeId id, std::uint32_t token) const {
  for (const core::Event& event : nodes_[id].log.events) {
    const auto* end = std::get_if<core::SendEnded>(&event.what);
    if (end && end->token == token) return end;
  }
  return nullptr;
}

// ---- time ---------------------------------------------------------------------------------

void VirtualRing::at(Time time, std::function<void()> action) {
  arrivals_.push({std::max(time, now_), order_++, 0, 0, 0, {}, std::move(action)});
}

void VirtualRing::run_until(Time until) {
  settle_touched();
  while (!arrivals_.empty() && arrivals_.top().at <= until) step();
  now_ = std::max(now_, until);
}

bool VirtualRing::run_until(const std::function<bool()>& done, Duration limit) {
  const Time until = now_ + limit;
  settle_touched();
  while (!done()) {
    if (arrivals_.empty() || arrivals_.top().at > until) return false;
    step();
  }
  return true;
}

bool VirtualRing::join() {
  const auto joined = [&] {
    return std::all_of(nodes_.begin(), nodes_.end(), [](const Node& n) {
      return !n.alive || n.controller->membership().accepts_sends();
    });
  };
  return run_until(joined, std::chrono::seconds(10));
}

// One instant: everything that arrives at it, then every node it touched decides.
void VirtualRing::step() {
  now_ = arrivals_.top().at;
  while (!arrivals_.empty() && arrivals_.top().at == now_) {
    const Arrival arrival = arrivals_.top();
    arrivals_.pop();
    deliver(arrival);
  }
  settle_touched();
}

void VirtualRing::deliver(const Arrival& arrival) {
  if (arrival.action) return arrival.action();
  Node& to = nodes_[arrival.to];
  if (!to.alive) return;
  if (!arrival.bytes.empty() && nodes_[arrival.from].line_epoch != arrival.epoch) return;
  wire::ByteView rest{arrival.bytes.data(), arrival.bytes.size()};
  while (!rest.empty()) {
    const wire::SliceParse parse = wire::parse_slice(rest);
    to.controller->receive(parse.slice, now_);
    rest = rest.from(parse.consumed);
  }
  if (arrival.bytes.empty() && to.wake == now_) to.wake = kNever;
  touch(arrival.to);
}

void VirtualRing::settle_touched() {
  while (!touched_.empty()) {
    const NodeId id = *touched_.begin();
    touched_.erase(touched_.begin());
    if (nodes_[id].alive) settle(id);
  }
}

void VirtualRing::settle(NodeId id) {
  Controller& controller = *nodes_[id].controller;
  controller.handle_timeout(now_);
  controller.run(now_);
  carry_line(id);
  give_out(id);
  schedule_wake(id);
}

void VirtualRing::carry_line(NodeId id) {
  Node& from = nodes_[id];
  SliceWriter& line = from.controller->line();
  if (line.empty()) return;
  SliceWriter arriving;
  wire::ByteView rest = line.view();
  while (!rest.empty()) {
    const wire::SliceParse parse = wire::parse_slice(rest);
    if (from.tap)
      from.tap(parse.slice, now_, arriving);
    else
      arriving.put(parse.slice.kind, parse.slice.bytes);
    rest = rest.from(parse.consumed);
  }
  line.clear();
  if (arriving.empty() || from.wire_cut || from.successor < 0) return;
  arrivals_.push({now_ + options_.relay_delay, order_++, id, static_cast<NodeId>(from.successor), from.line_epoch,
                  {arriving.view().begin(), arriving.view().end()}, nullptr});
}

void VirtualRing::give_out(NodeId id) {
  Controller& controller = *nodes_[id].controller;
  core::Event event;
  while (controller.take_event(now_, event)) {
    nodes_[id].log.events.push_back(event);
    on_event(id, event);
    touch(id);
  }
  core::ReceivedPacket packet;
  while (cpu_reads[id] && controller.take(now_, packet)) {
    nodes_[id].log.packets.push_back(packet);
    on_packet(id, packet);
    touch(id);
  }
}

void VirtualRing::schedule_wake(NodeId id) {
  const Time deadline = nodes_[id].controller->next_deadline(now_);
  if (deadline == kNever || deadline >= nodes_[id].wake) return;
  nodes_[id].wake = std::max(deadline, now_);
  arrivals_.push({nodes_[id].wake, order_++, id, id, 0, {}, nullptr});
}

}  // namespace limb_ring::sim
