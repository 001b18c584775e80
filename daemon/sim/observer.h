#pragma once

#include "core/network_controller.h"
#include "core/time.h"
#include "wire/control_message.h"
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

using core::Line;
using core::Time;
using wire::NodeId;

/// What happens to a node or to a line out of it.
enum class Incident : std::uint8_t {
  killed,
  started,
  frozen,
  thawed,
  cut,
  healed,
  output_replaced,  ///< its neighbour came or went: its line ends, or leads elsewhere
  lost_slice,
  damaged_slice,  ///< on the line out of the node
  late_slice,     ///< ... had been held back, and goes on
  resumed,        ///< the node stood still; what came in meanwhile goes on late
  cpu_reset,
  cancelled
};

/// Sees everything that happens in a virtual ring and changes nothing: a trace, the invariants.
class Observer {
 public:
  virtual ~Observer() = default;
  /// A CPU asks; the token its SendEnded will carry is in the request.
  virtual void asked(NodeId, const core::SendRequest&, Time) {}
  virtual void asked(NodeId, const core::InterruptRequest&, Time) {}
  /// A slice leaves a node, before any fault of the line.
  virtual void leaves(NodeId, const wire::Slice&, Time) {}
  /// A slice is about to come into a node.
  virtual void arrives(NodeId, const wire::Slice&, Time) {}
  /// A fold word is about to come into a node, on that line.
  virtual void word_arrives(NodeId, wire::FoldWord, Line, Time) {}
  /// A line into a node comes up, or is lost.
  virtual void input_changes(NodeId, Line, Time) {}
  /// The lines out of a node take nothing more for now (false); they take slices again, or one comes up (true).
  virtual void output_ready(NodeId, bool, Time) {}
  /// The CPU of a node is there, or gone.
  virtual void cpu_present(NodeId, bool, Time) {}
  /// A node gives out an event, or a packet to its CPU.
  virtual void event(NodeId, const core::Event&) {}
  virtual void packet(NodeId, const core::ReceivedPacket&) {}
  /// These nodes and the others lose each other; nobody: all reach each other again.
  virtual void parted(const core::RingOrder&, Time) {}
  /// A fault, or its end: what the ring promises is weaker for a while. The line counts for faults of a line only.
  virtual void incident(NodeId, Incident, Time, Line) {}
};

}  // namespace limb_ring::sim
