#pragma once

#include "core/time.h"
#include "wire/slice.h"

namespace limb_ring::sim {

/// A node of a virtual ring that is not ours, in place of a NetworkController. The ring tells it who is beside it; it
/// says itself when it has connected (VirtualRing::guest_connected(), guest_accepts()). First line only. (ours)
class Guest {
 public:
  virtual ~Guest() = default;
  /// Node `from` is before it now, and asks to connect.
  virtual void wired_from(wire::NodeId from) = 0;
  /// Nobody is before it any more, or its wire is cut.
  virtual void input_gone() = 0;
  /// Node `to` is the one to connect to.
  virtual void wired_to(wire::NodeId to) = 0;
  virtual void output_gone() = 0;
  virtual void receive(const wire::Slice& slice, core::Time now) = 0;
  /// What it puts onto its line now, behind what is there.
  virtual void give_out(wire::SliceWriter& slices) = 0;
};

}  // namespace limb_ring::sim
