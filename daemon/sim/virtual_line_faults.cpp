#include "sim/virtual_line_faults.h"

#include <algorithm>
#include <utility>

namespace limb_ring::sim {

using core::Line;
using core::Time;

using wire::NodeId;

VirtualLineFaults::VirtualLineFaults(VirtualRing& ring, std::uint64_t seed) : ring_(ring) {
  std::mt19937_64 seeds(seed);
  for (const Line line : ring.lines()) {
    for (unsigned id = 0; id < ring.size(); ++id)
      lines_[static_cast<std::size_t>(line)].emplace_back(seeds(),
                                                          ring.settings(static_cast<NodeId>(id)).byte_time_out);
  }
  ring.add_observer(*this);
}

void VirtualLineFaults::tap_all() {
  each_line([this](NodeId id, Line line) { tap(id, line); });
}

void VirtualLineFaults::tap(NodeId id, Line line) {
  const auto tap = [this, id, line](const wire::Slice& slice, Time, wire::SliceWriter& arriving) {
    pass(id, line, slice, arriving);
  };
  ring_.tap(id, tap, line);
}

void VirtualLineFaults::begin(const fault::Fault& fault) {
  const Line line = fault.second_line ? Line::second : Line::first;
  for (const NodeId id : fault.nodes) begin(id, line, fault);
}

fault::LineFaults::Id VirtualLineFaults::begin(NodeId id, Line line, const fault::Fault& fault) {
  const auto begun = wire_of(id, line).faults.begin(fault, ring_.now());
  poll(id, line);
  return begun;
}

bool VirtualLineFaults::remove(NodeId id, Line line, fault::LineFaults::Id fault) {
  const bool removed = wire_of(id, line).faults.remove(fault);
  poll(id, line);
  return removed;
}

void VirtualLineFaults::clear(NodeId id, Line line) {
  wire_of(id, line).faults.clear();
  poll(id, line);
}

std::vector<fault::LineFaults::Listed> VirtualLineFaults::list(NodeId id, Line line) {
  return wire_of(id, line).faults.list(ring_.now());
}

const fault::LineCounters& VirtualLineFaults::counters(NodeId id, Line line) const {
  return lines_[static_cast<std::size_t>(line)][id].faults.counters();
}

bool VirtualLineFaults::at_rest() const {
  bool at_rest = true;
  each_line([&](NodeId id, Line line) {
    const Wire& wire = lines_[static_cast<std::size_t>(line)][id];
    at_rest = at_rest && wire.wake == core::kNever && wire.faults.at_rest(ring_.now());
  });
  return at_rest;
}

void VirtualLineFaults::mend_all() {
  each_line([this](NodeId id, Line line) {
    wire_of(id, line).faults.clear();
    poll(id, line);
  });
}

void VirtualLineFaults::pass(NodeId id, Line line, const wire::Slice& slice, wire::SliceWriter& arriving) {
  fault::LineFaults& faults = wire_of(id, line).faults;
  if (faults.idle()) return arriving.put(slice.kind, slice.bytes);
  faults.pass(slice, ring_.now());
  faults.take(ring_.now(), arriving);
  poll_later(id, line);
}

void VirtualLineFaults::pass_damaged(NodeId id, Line line, const wire::Slice& slice, std::size_t at, std::uint8_t bits,
                                     wire::SliceWriter& arriving) {
  std::array<std::uint8_t, wire::kMaxSliceSize> bytes;
  std::copy(slice.bytes.begin(), slice.bytes.end(), bytes.begin());
  bytes[at] ^= bits;
  pass(id, line, {slice.kind, {bytes.data(), slice.bytes.size}}, arriving);
}

// Slices held back on a line are lost with it, and do not go onto the line that takes its place.
void VirtualLineFaults::incident(NodeId id, Incident incident, Time, Line line) {
  if (incident == Incident::output_replaced || incident == Incident::cut) wire_of(id, line).faults.line_lost();
}

void VirtualLineFaults::poll(NodeId id, Line line) {
  Wire& wire = wire_of(id, line);
  const bool cut = wire.faults.cut(ring_.now());
  const bool was_cut = std::exchange(wire.cut, cut);
  if (cut && !was_cut) cut_line(id, line);
  if (!cut && was_cut) ring_.heal(id, line);
  wire.faults.take(ring_.now(), late_);
  if (!late_.empty()) ring_.put_late(id, late_, line);
  late_.clear();
  poll_later(id, line);
}

// If both wires of a cable are cut, no word gets across: each end sees for itself that nobody is there, as a daemon
// sees it by its connection.
void VirtualLineFaults::cut_line(NodeId id, Line line) {
  ring_.cut(id, line);
  if (!ring_.settings(id).fold_back) return;
  const core::RingOrder& order = ring_.order();
  const NodeId first = line == Line::first ? id : core::node_after(order, id, order.size() - 1);
  if (cut(first, Line::first) && cut(core::node_after(order, first, 1), Line::second)) ring_.cut_cable(first);
}

void VirtualLineFaults::poll_later(NodeId id, Line line) {
  Wire& wire = wire_of(id, line);
  Time next = wire.faults.next_deadline();
  // A line that goes down after a packet goes down once that packet is through.
  if (next <= ring_.now()) next = ring_.now() + ring_.settings(id).relay_delay + core::Duration{1};
  if (next >= wire.wake) return;
  wire.wake = next;
  ring_.at(next, [this, id, line, next] {
    if (wire_of(id, line).wake != next) return;  // an earlier poll has taken its place
    wire_of(id, line).wake = core::kNever;
    poll(id, line);
  });
}

using core::Duration;
using namespace std::chrono_literals;

void set_short_times(core::Settings& settings, bool paced, bool fold_back) {
  settings.send_timeout_least = paced ? Duration{0} : Duration{100us};
  settings.refused_for = 2ms;
  settings.refused_backoff = 20us;
  settings.refused_backoff_most = 300us;
  settings.queue_timeout = 20ms;
  settings.stall = 50us;
  settings.beacon = 1ms;
  settings.break_grace = settings.fold_permission = 300us;
  settings.receive_buffers = 3;
  settings.send_queue = 6;
  settings.fold_back = fold_back;
  settings.wired = {true, false, true, true, true, true, true, true};
}

bool is_traffic(const wire::Slice& slice) {
  const bool control =
      slice.kind != wire::SliceKind::interrupt && slice.bytes.size >= 13 && slice.bytes[slice.bytes.size - 5] >> 2 == 1;
  return !control && slice.kind != wire::SliceKind::start;
}

void run_until_calm(VirtualRing& ring, const Invariants& invariants, const std::uint64_t& traffic,
                    const std::function<bool()>& asked_to_stop) {
  constexpr Duration kStep = 1ms, kLongest = 400ms;
  const core::Settings& settings = ring.settings(ring.order().front());
  const Duration pause = std::max(10 * settings.beacon, 5 * settings.send_timeout());
  Duration quiet{0};
  for (Duration waited{0}; waited < kLongest && quiet < pause && !asked_to_stop(); waited += kStep) {
    const std::uint64_t before = traffic;
    ring.run_for(kStep);
    const bool calm = traffic == before && invariants.all_ended() && !not_whole(ring);
    quiet = calm ? quiet + kStep : Duration{0};
  }
}

std::optional<Violation> not_whole(VirtualRing& ring) {
  for (const wire::NodeId id : ring.order()) {
    const core::Membership& m = ring.node(id).membership();
    if (m.state() == core::NodeState::up && m.ring_size() == ring.order().size()) continue;
    return Violation{Promise::whole_again, ring.now(),
                     node_words(id) + " is " + to_string(m.state()) + " in a ring of " + std::to_string(m.ring_size()) +
                         " after all was mended"};
  }
  return std::nullopt;
}

std::optional<Violation> not_silent(const VirtualRing& ring, std::uint64_t slices) {
  if (slices == 0) return std::nullopt;
  return Violation{Promise::whole_again, ring.now(),
                   std::to_string(slices) + " slices of packets other than beacons still circulate"};
}

}  // namespace limb_ring::sim
