#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "judge/observation_file.h"
#include "judge/promise_judge.h"
#include "sim/virtual_ring.h"

namespace limb_ring::promises {

/// Observes every node of a virtual ring and has its promises judged. Time is shorter there than on a living one.
class JudgedRing : public sim::Observer {
 public:
  explicit JudgedRing(sim::VirtualRing& ring)
      : ring_(ring),
        judge_(
            ring.settings(ring.order()[0]).fold_back, [this](const Breach& breach) { breaches_.push_back(breach); },
            times()),
        nodes_(ring.size()) {
    for (const wire::NodeId id : ring.order())
      if (ring.alive(id)) begin(id);
    ring.add_observer(*this);
  }
  ~JudgedRing() override {
    for (const wire::NodeId id : ring_.order()) ring_.controller(id).set_journal(nullptr);
  }

  static JudgeTimes times() {
    using namespace std::chrono_literals;
    return {1ms, 1ms, 10ms, 1s};
  }
  void incident(wire::NodeId id, sim::Incident incident, core::Time, core::Line) override {
    if (incident == sim::Incident::killed) judge_.ends(id);
    if (incident == sim::Incident::started) begin(id);
  }
  void arrives(wire::NodeId, const wire::Slice&, core::Time now) override {
    if (now < next_round_) return;
    judge_.round_is_over();
    next_round_ = now + std::chrono::microseconds(50);
  }
  /// Nothing more will come.
  void finish() {
    for (int i = 0; i < 100; ++i) judge_.round_is_over();
  }
  PromiseJudge& judge() { return judge_; }
  const std::vector<Breach>& breaches() const { return breaches_; }
  std::string first() const {
    return breaches_.empty() ? "" : std::string(to_string(breaches_[0].promise)) + ": " + breaches_[0].what;
  }

 private:
  struct Node final : ObservationSink {
    Node(PromiseJudge& told, sim::VirtualRing& ring, wire::NodeId at)
        : judge(told),
          id(at),
          observer(
              ring.settings(at), std::chrono::nanoseconds(0),
              [&ring, at] { return ring.controller(at).received_waiting(); }, *this, std::chrono::microseconds(50)) {}
    void put(const Observation& seen) override { judge.see(id, seen); }
    PromiseJudge& judge;
    wire::NodeId id;
    NodeObserver observer;
  };

  void begin(wire::NodeId id) {
    const auto now = std::chrono::duration_cast<std::chrono::nanoseconds>(ring_.now().time_since_epoch());
    const auto state = static_cast<std::uint8_t>(ring_.controller(id).membership().state());
    judge_.begins(id, state, longest_send(ring_.settings(id)), now.count());
    nodes_[id] = std::make_unique<Node>(judge_, ring_, id);
    ring_.controller(id).set_journal(&nodes_[id]->observer);
  }

  sim::VirtualRing& ring_;
  PromiseJudge judge_;
  std::vector<std::unique_ptr<Node>> nodes_;
  std::vector<Breach> breaches_;
  core::Time next_round_{};
};

}  // namespace limb_ring::promises
