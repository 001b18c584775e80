#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/network_controller.h"
#include "io/link_counters.h"
#include "io/node_clock.h"
#include "io/refusals.h"
#include "node/line_breaker.h"

namespace limb_ring::runtime {

/// What comes out of the network controller. Handlers may call into the controller.
struct DriverListener {
  virtual ~DriverListener() = default;
  virtual void on_event(const core::Event& event) = 0;
  /// After all else of a round: packets may wait for the CPU.
  virtual void on_round_end() = 0;
  /// A link came or went; for people.
  virtual void on_link(std::string_view what) = 0;
};

/// Sees what enters and leaves the node's controller, and changes nothing. In a folded ring it sees each packet once,
/// on whichever line it comes; packets that are only passed back on the second line are not shown.
struct LineTap {
  using Time = event_loop::NodeClock::Time;

  virtual ~LineTap() = default;
  virtual void on_input(const wire::Slice& slice, wire::NodeId from, Time at) = 0;
  virtual void on_output(wire::ByteView framed_slices, wire::NodeId to, Time at) = 0;
  /// Something is missing there, or the line has ended.
  virtual void on_input_gap(Time at) = 0;
  virtual void on_output_gap(Time at) = 0;
};

/// The nodes at the far ends of a node's two links of one line; nothing: the link is down.
struct LineEnds {
  std::optional<std::uint8_t> from, to;
};

/// Nodes that cannot connect with this one on a line, because one of the two refuses; null: there are none.
struct LineRefusals {
  const link::Refusals* by_input = nullptr;
  const link::Refusals* of_output = nullptr;
};

/// What drives the network controller of a node, as all that is built upon it sees it: links and the machine's clock,
/// or a virtual ring.
class NodeDriver {
 public:
  virtual ~NodeDriver() = default;

  virtual core::NetworkController& controller() = 0;
  virtual const core::NetworkController& controller() const = 0;
  /// @name What the node's CPU does to the controller
  ///@{
  virtual bool take(core::ReceivedPacket& packet) { return controller().take(now(), packet); }
  virtual void set_cpu_present(bool present) { controller().set_cpu_present(present); }
  virtual void cpu_reset(core::Owner owner) { controller().cpu_reset(owner, now()); }
  ///@}
  virtual event_loop::NodeClock& clock() = 0;
  /// The controller's time. It stands still while a batch, and all that follows from it, is handled.
  virtual core::Time now() const = 0;
  /// Which line was lost last, and why; for people. Empty: none.
  virtual std::string last_loss() const { return ""; }
  /// When this driver was made, on the same clock.
  virtual core::Time started() const { return core::Time{}; }
  /// `when` on clock(), rounded up so that a timer never fires early.
  virtual event_loop::NodeClock::Time steady(core::Time when) const = 0;

  /// To be called after anything was asked of the controller. Calling it from within a handler
  /// only makes another round follow.
  virtual void pump() = 0;
  /// Calls pump() once at the end of the event loop's turn, however often it is asked for in that turn. For calls that
  /// come with every packet.
  virtual void pump_soon() = 0;
  /// Makes the call between two pump(), all in one instant: what was asked for before has begun by then, and has not
  /// ended, however long this process has to wait meanwhile. Not to be called from within a handler.
  virtual void pump_around(const std::function<void(core::Time now)>& call) {
    pump();
    call(now());
    pump();
  }
  virtual void close() = 0;
  /// The links' listening sockets are where they were made.
  virtual bool is_in_place() const = 0;
  /// Makes the links' listening sockets again, after the runtime folder was removed. @throw std::runtime_error
  virtual void listen_again() = 0;
  /// From now on `tap`, which may be null, sees the lines; it must outlive that.
  virtual void set_tap(LineTap* tap) = 0;

  /// From now on `journal`, which may be null, sees all that goes into the controller and comes out; it must outlive
  /// that.
  virtual void set_journal(core::Journal* journal) { controller().set_journal(journal); }

  /// @name Its lines. @pre has_second_line(), for the second
  ///@{
  bool has_second_line() const { return controller().settings().fold_back; }
  virtual LineEnds ends(core::Line line) const = 0;
  virtual const link::InputCounters& input_counters(core::Line line) const = 0;
  virtual const link::OutputCounters& output_counters(core::Line line) const = 0;
  /// Who was refused at the line's input, and who has refused its output. A virtual ring refuses nobody.
  virtual LineRefusals refusals(core::Line) const { return {}; }
  virtual LineBreaker& breaker(core::Line line) = 0;
  virtual const LineBreaker& breaker(core::Line line) const = 0;
  ///@}
  /// When the first line's input was last lost. If it fell silent instead: when it was last heard.
  virtual core::Time input_lost_at() const = 0;
  /// When this node learned of a broken line.
  virtual core::Time broken_since() const = 0;
};

}  // namespace limb_ring::runtime
