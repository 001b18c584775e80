#pragma once

#include "config/line_faults.h"
#include "io/output.h"
#include "io/packet_timer.h"
#include "node/clock.h"
#include "node/line_breaker.h"

namespace limb_ring::runtime {

/// A line out of this node with its faults on purpose, between the Engine and the Output. While there is a fault, every
/// slice passes through it; while there is none, it costs nothing. (ours)
///
/// Idles are sent by the link itself and do not pass through here. So a line that drops every packet is not silent,
/// but one that stalls or is cut is.
class FaultyLine final : public LineBreaker {
 public:
  FaultyLine(boost::asio::io_context& io, const Clock& clock, link::Output& output);

  /// The wire is neither cut nor held: the output is, or will be, connected.
  bool carries() const { return wire_ == link::Wire::whole; }
  void put(wire::ByteView framed_slices, core::Time now) {
    if (active_) return pass_all(framed_slices, now);
    output_.write(framed_slices);
  }
  bool mended() const override { return output_.up() || !carries(); }
  /// The output was lost, or leads to another node.
  void line_lost() { faults_.line_lost(); }

  fault::LineFaults::Id begin(const fault::Fault& fault, core::Time now) override;
  bool remove(fault::LineFaults::Id id, core::Time now) override;
  void clear(core::Time now) override;
  std::vector<fault::LineFaults::Listed> list(core::Time now) override { return faults_.list(now); }

  const fault::LineCounters& counters() const override { return faults_.counters(); }
  void close() { timer_.cancel(); }

 private:
  void pass_all(wire::ByteView framed_slices, core::Time now);
  void pass(const wire::Slice& slice, core::Time now);
  void update(core::Time now);
  void write_due(core::Time now);
  void arm_timer();

  const Clock& clock_;
  link::Output& output_;
  fault::LineFaults faults_;
  event_loop::PacketTimer timer_;
  wire::SliceWriter due_;
  link::Wire wire_ = link::Wire::whole;
  bool active_ = false;  ///< something is wrong, or still held back
};

}  // namespace limb_ring::runtime
