#include "node/node_line.h"

#include "wire/slice.h"

namespace limb_ring::runtime {

NodeLine::NodeLine(boost::asio::io_context& io, const Clock& clock, const setup::LinkSettings& links,
                   LineHandler& handler)
    : line_(links.line),
      handler_(handler),
      input_(io, links.input, *this),
      output_(io, links.output, *this),
      faulty_line_(io, clock, output_) {}

void NodeLine::write(wire::SliceWriter& slices, core::Time now) {
  if (slices.empty()) return;
  faulty_line_.put(slices.view(), now);
  slices.clear();
}

void NodeLine::close() {
  input_.close();
  output_.close();
  faulty_line_.close();
}

void NodeLine::on_output_lost(std::string_view reason) {
  faulty_line_.line_lost();
  handler_.on_output_lost(line_, reason);
}

// The seed 0 has no effect: every fault with random damage brings its own seed.
FaultyLine::FaultyLine(boost::asio::io_context& io, const Clock& clock, link::Output& output)
    : clock_(clock), output_(output), faults_(0), timer_(io, [this] { update(clock_.now()); }) {}

fault::LineFaults::Id FaultyLine::begin(const fault::Fault& fault, core::Time now) {
  const auto id = faults_.begin(fault, now);
  update(now);
  return id;
}

bool FaultyLine::remove(fault::LineFaults::Id id, core::Time now) {
  const bool removed = faults_.remove(id);
  update(now);
  return removed;
}

void FaultyLine::clear(core::Time now) {
  faults_.clear();
  update(now);
}

void FaultyLine::pass_all(wire::ByteView framed_slices, core::Time now) {
  wire::each_slice(framed_slices, [&](const wire::Slice& slice) { pass(slice, now); });
  update(now);
}

// A reordered datagram is sent after the next one but keeps its own sequence number, so the receiver discards it. The
// faults therefore treat it as lost: they put only the other slices onto the line. Slices that come before the late
// datagram are written first, so that they get the lower sequence numbers.
void FaultyLine::pass(const wire::Slice& slice, core::Time now) {
  const auto late = faults_.counters().line_reordered;
  faults_.pass(slice, now);
  const bool in_one_piece = slice.kind == wire::SliceKind::whole || slice.kind == wire::SliceKind::interrupt;
  if (faults_.counters().line_reordered == late || !in_one_piece) return;
  wire::SliceWriter one;
  one.put(slice.kind, slice.bytes);
  write_due(now);
  output_.write_late(one.view());
}

void FaultyLine::update(core::Time now) {
  using link::Wire;
  wire_ = faults_.cut(now) ? Wire::cut : faults_.stalled(now) ? Wire::held : Wire::whole;
  output_.set_wire(wire_);
  write_due(now);
  active_ = !faults_.idle();
  arm_timer();
}

void FaultyLine::write_due(core::Time now) {
  faults_.take(now, due_);
  if (!due_.empty()) output_.write(due_.view());
  due_.clear();
}

void FaultyLine::arm_timer() {
  const core::Time due = faults_.next_deadline();
  if (due == core::kNever) return;
  timer_.expires_at(clock_.steady(due));
}

}  // namespace limb_ring::runtime
