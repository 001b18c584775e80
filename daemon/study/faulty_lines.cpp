#include "study/faulty_lines.h"

namespace limb_ring::study {

using core::Time;
using sim::Way;
using wire::NodeId;

FaultyLines::FaultyLines(sim::VirtualRing& ring, std::uint64_t seed) : ring_(ring) {
  std::mt19937_64 seeds(seed);
  for (const Way way : {Way::first, Way::second}) {
    if (way == Way::second && !ring.settings(0).fold_back) break;
    for (unsigned id = 0; id < ring.size(); ++id)
      lines_[static_cast<std::size_t>(way)].emplace_back(seeds(), ring.settings(static_cast<NodeId>(id)).byte_time_out);
  }
  ring.add_witness(*this);
}

void FaultyLines::tap_all() {
  each_line([this](NodeId id, Way way) {
    const auto tap = [this, id, way](const wire::Slice& slice, Time, wire::SliceWriter& arriving) {
      pass(id, way, slice, arriving);
    };
    ring_.tap(id, tap, way);
  });
}

void FaultyLines::begin(const fault::Fault& fault) {
  const Way way = fault.second_line ? Way::second : Way::first;
  for (const NodeId id : fault.nodes) {
    line(id, way).faults.begin(fault, ring_.now());
    look(id, way);
  }
}

void FaultyLines::mend_all() {
  each_line([this](NodeId id, Way way) {
    line(id, way).faults.clear();
    look(id, way);
  });
}

void FaultyLines::pass(NodeId id, Way way, const wire::Slice& slice, wire::SliceWriter& arriving) {
  fault::LineFaults& faults = line(id, way).faults;
  if (faults.idle()) return arriving.put(slice.kind, slice.bytes);
  faults.pass(slice, ring_.now());
  faults.take(ring_.now(), arriving);
  look_later(id, way);
}

// What was under way on a line that is gone never comes out of the next one.
void FaultyLines::fault(NodeId id, sim::Fault fault, Time, Way way) {
  if (fault == sim::Fault::output_replaced || fault == sim::Fault::cut) line(id, way).faults.line_lost();
}

void FaultyLines::look(NodeId id, Way way) {
  Line& line = this->line(id, way);
  const bool cut = line.faults.cut(ring_.now());
  if (cut && !line.cut) ring_.cut(id, way);
  if (!cut && line.cut) ring_.heal(id, way);
  line.cut = cut;
  line.faults.take(ring_.now(), late_);
  if (!late_.empty()) ring_.put_late(id, late_, way);
  late_.clear();
  look_later(id, way);
}

void FaultyLines::look_later(NodeId id, Way way) {
  Line& line = this->line(id, way);
  Time next = line.faults.next_deadline();
  // A line that a packet takes down by having passed it goes down behind that packet.
  if (next <= ring_.now()) next = ring_.now() + ring_.settings(id).relay_delay + core::Duration{1};
  if (next >= line.wake) return;
  line.wake = next;
  ring_.at(next, [this, id, way, next] {
    if (this->line(id, way).wake != next) return;  // an earlier look has taken its place
    this->line(id, way).wake = core::kNever;
    look(id, way);
  });
}

}  // namespace limb_ring::study
