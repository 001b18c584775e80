#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "model/comparison.h"
#include "sim/virtual_ring.h"

namespace limb_ring::model {

/// Compares every life of every node of a virtual ring with the model.
class ComparedRing final : public sim::Observer {
 public:
  /// @param ring has been made just now: what its nodes have been told by then is told to their models
  explicit ComparedRing(sim::VirtualRing& ring) : ring_(ring), lives_(ring.size()) {
    for (const wire::NodeId id : ring.order())
      if (ring.alive(id)) begin(id);
    ring.add_observer(*this);
  }
  void incident(wire::NodeId id, sim::Incident incident, core::Time, core::Line) override {
    if (incident == sim::Incident::killed) end(id);
    if (incident == sim::Incident::started) begin(id);
    const bool still = incident == sim::Incident::frozen || incident == sim::Incident::late_slice;
    if (still && lives_[id] != nullptr) lives_[id]->stands_still();
  }
  /// The first of all.
  std::optional<Difference> difference() {
    for (const wire::NodeId id : ring_.order()) note(id);
    return difference_;
  }
  /// Outputs, of the ended lives and the others.
  std::uint64_t compared() const {
    std::uint64_t all = compared_;
    for (const auto& life : lives_) all += life == nullptr ? 0 : life->compared();
    return all;
  }

 private:
  void begin(wire::NodeId id) {
    core::NetworkController& controller = ring_.controller(id);
    lives_[id] = std::make_unique<Comparison>(controller, ring_.now());
    Node& model = lives_[id]->model();
    model.apply(core::input::CpuPresent{true}, ring_.now());
    const bool output = controller.membership().state() != NodeState::starting;
    for (const core::Line line : ring_.lines()) {
      if (const auto from = ring_.predecessor(id, line)) model.apply(core::input::InputUp{line, *from}, ring_.now());
      if (const auto to = ring_.successor(id, line); to && output)
        model.apply(core::input::OutputUp{line, *to}, ring_.now());
    }
  }
  void note(wire::NodeId id) {
    if (lives_[id] == nullptr || !lives_[id]->difference()) return;
    if (!difference_ || lives_[id]->difference()->at < difference_->at) difference_ = lives_[id]->difference();
  }
  void end(wire::NodeId id) {
    note(id);
    if (lives_[id] != nullptr) compared_ += lives_[id]->compared();
    lives_[id].reset();
  }

  sim::VirtualRing& ring_;
  std::vector<std::unique_ptr<Comparison>> lives_;
  std::optional<Difference> difference_;
  std::uint64_t compared_ = 0;
};

}  // namespace limb_ring::model
