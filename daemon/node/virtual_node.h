#pragma once

#include <map>
#include <string>

#include "config/fault_parse.h"
#include "node/node_driver.h"
#include "node/steering.h"
#include "sim/virtual_line_faults.h"
#include "sim/virtual_ring.h"

namespace limb_ring::virtual_host {

/// What all nodes of a virtual ring share.
struct VirtualWorld {
  sim::VirtualRing& ring;
  sim::VirtualLineFaults& faults;
  std::function<void()> on_expired;  ///< called when a timer of a node has run out
};

/// The line out of a node of a virtual ring.
class VirtualBreaker final : public runtime::LineBreaker {
 public:
  VirtualBreaker(const VirtualWorld& world, wire::NodeId id, core::Line line) : world_(world), id_(id), line_(line) {}

  fault::LineFaults::Id begin(const fault::Fault& fault, core::Time) override {
    world_.faults.tap(id_, line_);
    return world_.faults.begin(id_, line_, fault);
  }
  bool remove(fault::LineFaults::Id fault, core::Time) override { return world_.faults.remove(id_, line_, fault); }
  void clear(core::Time) override { world_.faults.clear(id_, line_); }
  std::vector<fault::LineFaults::Listed> list(core::Time) override { return world_.faults.list(id_, line_); }
  const fault::LineCounters& counters() const override { return world_.faults.counters(id_, line_); }
  bool mended() const override;

 private:
  VirtualWorld world_;
  wire::NodeId id_;
  core::Line line_;
};

/// Drives a node of a virtual ring: the ring's own time does, so there is little left but to ask it.
class VirtualNode final : public runtime::NodeDriver {
 public:
  /// @param world, listener outlive this
  VirtualNode(const VirtualWorld& world, wire::NodeId id, runtime::DriverListener& listener);

  core::NetworkController& controller() override { return world_.ring.controller(id_); }
  const core::NetworkController& controller() const override { return world_.ring.controller(id_); }
  /// Whoever observes the ring is told.
  bool take(core::ReceivedPacket& packet) override { return world_.ring.take(id_, packet); }
  void set_cpu_present(bool present) override { world_.ring.set_cpu_present(id_, present); }
  void cpu_reset(core::Owner owner) override;
  VirtualClock& clock() override { return clock_; }
  core::Time now() const override { return world_.ring.time_of(id_); }
  event_loop::NodeClock::Time steady(core::Time when) const override {
    return VirtualClock::at(world_.ring.in_ring(id_, when));
  }

  /// The node acts before time goes on.
  void pump() override { world_.ring.node(id_); }
  void pump_soon() override { pump(); }
  void close() override { closed_ = true; }
  bool is_in_place() const override { return true; }
  void listen_again() override {}
  void set_tap(runtime::LineTap* tap) override { tap_ = tap; }

  runtime::LineEnds ends(core::Line line) const override;
  const link::InputCounters& input_counters(core::Line line) const override { return in_[index(line)]; }
  const link::OutputCounters& output_counters(core::Line line) const override { return out_[index(line)]; }
  runtime::LineBreaker& breaker(core::Line line) override { return line == core::Line::first ? first_ : second_; }
  const runtime::LineBreaker& breaker(core::Line line) const override {
    return line == core::Line::first ? first_ : second_;
  }
  core::Time input_lost_at() const override { return input_lost_at_; }
  core::Time broken_since() const override { return broken_since_; }
  core::Time started() const override { return started_; }

  /// @name From the ring
  ///@{
  void on_event(const core::Event& event);
  /// Packets may wait for the CPU.
  void on_given_out();
  void on_arrival(const wire::Slice& slice, core::Time now);
  void on_departure(const wire::Slice& slice, core::Time now);
  /// Neighbours may have come or gone.
  void look_at_lines();
  ///@}

 private:
  static std::size_t index(core::Line line) { return static_cast<std::size_t>(line); }
  void tell_change(core::Line line, const runtime::LineEnds& before, const runtime::LineEnds& after);
  void tell(const runtime::LinkChange& change);

  VirtualWorld world_;
  VirtualClock clock_;
  wire::NodeId id_;
  runtime::DriverListener& listener_;
  VirtualBreaker first_, second_;
  std::array<runtime::LineEnds, 2> ends_;  ///< as last told
  runtime::LineTap* tap_ = nullptr;
  core::Time input_lost_at_{};
  core::Time broken_since_{};
  core::Time started_;
  /// There are no links. Only slices and bytes are counted, as if they had gone through one.
  std::array<link::InputCounters, 2> in_;
  std::array<link::OutputCounters, 2> out_;
  bool closed_ = false;
  wire::SliceWriter framed_;
};

/// Whoever has the nodes of a virtual ring.
class NodePower {
 public:
  virtual ~NodePower() = default;
  /// The node is dead: as SIGKILL of its daemon, and its neighbours bypass it.
  virtual void off(wire::NodeId node) = 0;
  /// A dead node comes up. @return why not; empty: it does
  virtual std::string on(wire::NodeId node) = 0;
  /// The node stands still, and is bypassed; later it goes on where it stood.
  /// @param clock_stands its controller's clock stands, too
  virtual void freeze(wire::NodeId node, bool clock_stands) = 0;
  virtual void thaw(wire::NodeId node) = 0;
};

/// Faults of whole nodes of a virtual ring: kill, start, power_cycle, freeze, suspend, thaw, step_clock. What holds is
/// noted in the ring's folder, as on a live ring (io/node_notes.h), for all who do not get an answer from the node.
/// (ours)
class NodeFaults {
 public:
  /// The notes of an earlier ring are removed. @param ring, power outlive this
  NodeFaults(sim::VirtualRing& ring, NodePower& power, fault::RingNodes nodes, std::string folder);

  /// Does it at this instant, to all of its nodes or to none. A node frozen for a time is thawed by the ring's clock.
  /// @pre a fault of nodes, and no program acts: called from an action of the ring (VirtualRing::at)
  /// @return why not; empty: it is done
  std::string begin(const fault::Fault& fault);

  using State = fault::Node;
  State state(wire::NodeId node) const;
  bool is_dead(wire::NodeId node) const { return state(node) == State::dead; }
  bool is_frozen(wire::NodeId node) const { return state(node) == State::frozen; }

 private:
  struct Node {
    State state = State::runs;
    unsigned freezes = 0;
  };

  std::string why_not(fault::Name what, wire::NodeId node) const;
  std::string carry_out(const fault::Fault& fault);
  std::string power_cycle(const fault::Fault& fault);
  std::string start(wire::NodeId node);
  void kill(wire::NodeId node);
  void freeze(wire::NodeId node, const fault::Fault& fault);
  void thaw(wire::NodeId node);
  std::string note(const fault::Fault& fault) const;
  void forget_new_notes(const fault::Fault& fault) const;
  const std::string& name_of(wire::NodeId node) const;

  sim::VirtualRing& ring_;
  NodePower& power_;
  fault::RingNodes nodes_;
  std::string folder_;
  std::map<wire::NodeId, Node> states_;
};

}  // namespace limb_ring::virtual_host
