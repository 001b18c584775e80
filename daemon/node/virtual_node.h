#pragma once

#include "node/node_driver.h"
#include "node/virtual_clock.h"
#include "sim/virtual_line_faults.h"

namespace limb_ring::virtual_host {

/// What all nodes of a virtual ring share.
struct VirtualWorld {
  sim::VirtualRing& ring;
  sim::VirtualLineFaults& faults;
  std::function<void()> on_expired;  ///< called where a timer of a node has run out
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
  core::Time now() const override { return world_.ring.now(); }
  event_loop::NodeClock::Time steady(core::Time when) const override { return VirtualClock::at(when); }

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
  void say(core::Line line, const std::string& what);

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

}  // namespace limb_ring::virtual_host
