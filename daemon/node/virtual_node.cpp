#include "node/virtual_node.h"

#include <string>

#include "node/send_owner.h"

namespace limb_ring::virtual_host {

using core::Line;
using runtime::LineEnds;

bool VirtualBreaker::mended() const {
  return world_.faults.cut(id_, line_) || world_.ring.successor(id_, line_).has_value();
}

VirtualNode::VirtualNode(const VirtualWorld& world, wire::NodeId id, runtime::DriverListener& listener)
    : world_(world),
      clock_(world.ring, world.on_expired),
      id_(id),
      listener_(listener),
      first_(world, id, Line::first),
      second_(world, id, Line::second),
      started_(world.ring.now()) {}

LineEnds VirtualNode::ends(Line line) const {
  const auto number = [](std::optional<wire::NodeId> node) {
    return node ? std::optional<std::uint8_t>(std::uint8_t{*node}) : std::nullopt;
  };
  return {number(world_.ring.predecessor(id_, line)), number(world_.ring.successor(id_, line))};
}

static_assert(runtime::SendOwner::of(runtime::SendOwner::Kind::ring_user).to_core() == sim::VirtualRing::kUser);

// Sends that the ring's own user (VirtualRing::kUser) made for this CPU end with the CPU.
void VirtualNode::cpu_reset(core::Owner owner) {
  controller().cpu_reset(owner, now());
  world_.ring.reset_cpu(id_);
}

void VirtualNode::on_event(const core::Event& event) {
  if (const auto* change = std::get_if<core::StateChanged>(&event.what))
    if (change->after == core::NodeState::open_chain || change->after == core::NodeState::folded)
      broken_since_ = world_.ring.now();
  if (!closed_) listener_.on_event(event);
}

void VirtualNode::on_given_out() {
  if (closed_) return;
  const std::size_t waiting = controller().received_waiting();
  listener_.on_round_end();
  if (controller().received_waiting() != waiting) pump();
}

void VirtualNode::on_arrival(const wire::Slice& slice, core::Time now) {
  link::InputCounters& in = in_[index(world_.ring.input_line(id_))];
  ++in.slices;
  in.bytes += wire::kSliceHeaderSize + slice.bytes.size;
  if (tap_ == nullptr) return;
  const auto from = world_.ring.predecessor(id_, world_.ring.input_line(id_));
  tap_->on_input(slice, from.value_or(wire::kBroadcast), VirtualClock::at(now));
}

void VirtualNode::on_departure(const wire::Slice& slice, core::Time now) {
  out_[index(world_.ring.output_line(id_))].bytes += wire::kSliceHeaderSize + slice.bytes.size;
  if (tap_ == nullptr) return;
  const auto to = world_.ring.successor(id_, world_.ring.output_line(id_));
  if (!to) return;
  framed_.put(slice.kind, slice.bytes);
  tap_->on_output(framed_.view(), *to, VirtualClock::at(now));
  framed_.clear();
}

void VirtualNode::look_at_lines() {
  for (const Line line : controller().lines()) {
    LineEnds& known = ends_[static_cast<std::size_t>(line)];
    const LineEnds before = std::exchange(known, ends(line));
    tell_change(line, before, known);
  }
}

void VirtualNode::tell_change(Line line, const LineEnds& before, const LineEnds& after) {
  const event_loop::NodeClock::Time now = clock_.now();
  if (before.from && before.from != after.from) {
    if (tap_ != nullptr) tap_->on_input_gap(now);
    if (line == Line::first) input_lost_at_ = world_.ring.now();
    if (!after.from) say(line, "input lost");
  }
  if (before.to && before.to != after.to) {
    if (tap_ != nullptr) tap_->on_output_gap(now);
    if (!after.to) say(line, "output lost");
  }
  if (after.from && before.from != after.from) say(line, "input from node " + std::to_string(*after.from));
  if (after.to && before.to != after.to) say(line, "output to node " + std::to_string(*after.to));
}

void VirtualNode::say(Line line, const std::string& what) {
  if (!closed_) listener_.on_link((line == Line::second ? "second line: " : "") + what);
}

}  // namespace limb_ring::virtual_host
