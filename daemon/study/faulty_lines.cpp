#include "study/faulty_lines.h"

namespace limb_ring::study {

using core::Time;
using wire::NodeId;

FaultyLines::FaultyLines(sim::VirtualRing& ring, std::uint64_t seed) : ring_(ring) {
  std::mt19937_64 seeds(seed);
  for (unsigned id = 0; id < ring.size(); ++id)
    lines_.emplace_back(seeds(), ring.settings(static_cast<NodeId>(id)).byte_time_out);
  ring.add_witness(*this);
}

void FaultyLines::tap_all() {
  for (unsigned i = 0; i < ring_.size(); ++i) {
    const auto id = static_cast<NodeId>(i);
    ring_.tap(id, [this, id](const wire::Slice& slice, Time, wire::SliceWriter& arriving) {
      pass(id, slice, arriving);
    });
  }
}

void FaultyLines::begin(const fault::Fault& fault) {
  for (const NodeId id : fault.nodes) {
    lines_[id].faults.begin(fault, ring_.now());
    look(id);
  }
}

void FaultyLines::mend_all() {
  for (unsigned id = 0; id < ring_.size(); ++id) {
    lines_[id].faults.clear();
    look(static_cast<NodeId>(id));
  }
}

void FaultyLines::pass(NodeId id, const wire::Slice& slice, wire::SliceWriter& arriving) {
  fault::LineFaults& faults = lines_[id].faults;
  if (faults.idle()) return arriving.put(slice.kind, slice.bytes);
  faults.pass(slice, ring_.now());
  faults.take(ring_.now(), arriving);
  look_later(id);
}

// What was under way on a line that is gone never comes out of the next one.
void FaultyLines::fault(NodeId id, sim::Fault fault, Time) {
  if (fault == sim::Fault::output_replaced || fault == sim::Fault::cut) lines_[id].faults.line_lost();
}

void FaultyLines::look(NodeId id) {
  Line& line = lines_[id];
  const bool cut = line.faults.cut(ring_.now());
  if (cut && !line.cut) ring_.cut(id);
  if (!cut && line.cut) ring_.heal(id);
  line.cut = cut;
  line.faults.take(ring_.now(), late_);
  if (!late_.empty()) ring_.put_late(id, late_);
  late_.clear();
  look_later(id);
}

void FaultyLines::look_later(NodeId id) {
  Line& line = lines_[id];
  Time next = line.faults.next_deadline();
  // A line that a packet takes down by having passed it goes down behind that packet.
  if (next <= ring_.now()) next = ring_.now() + ring_.settings(id).relay_delay + core::Duration{1};
  if (next >= line.wake) return;
  line.wake = next;
  ring_.at(next, [this, id, next] {
    if (lines_[id].wake != next) return;  // an earlier look has taken its place
    lines_[id].wake = core::kNever;
    look(id);
  });
}

}  // namespace limb_ring::study
