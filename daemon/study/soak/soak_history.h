#pragma once

#include <array>
#include <variant>
#include <vector>

#include "sim/scenario.h"
#include "sim/virtual_ring.h"

namespace limb_ring::study {

/// One thing that was done to a ring: what, in the words of scenarios, and when. Nodes are ids.
struct RecordedStep {
  core::Time at{};
  std::variant<fault::Fault, scenario::Send, scenario::SoakAction> what;
};

/// All that was done to a ring, from keep() on, so that a scenario can do it again.
class SoakHistory {
 public:
  explicit SoakHistory(const sim::VirtualRing& ring) : ring_(ring) {}

  void keep() { kept_ = true; }
  const std::vector<RecordedStep>& steps() const { return steps_; }

  template <class What>
  void add(const What& what) {
    if (kept_) steps_.push_back({ring_.now(), what});
  }
  void add(fault::Name name, wire::NodeId node);
  void add(scenario::SoakAction::Kind kind, wire::NodeId node, bool second_line = false);

  /// A slice has left that node; to be called for each, since an action on one is known by its number in its instant.
  void count_slice(wire::NodeId node, core::Line line);
  /// What was done to the slice counted last. @param byte and `bits`: where it was damaged
  void add_slice(scenario::SoakAction::Kind kind, wire::NodeId node, core::Line line, std::size_t byte = 0,
                 std::uint8_t bits = 1);

 private:
  /// The slices that have left onto a line at one instant.
  struct AtInstant {
    core::Time at{core::Duration{-1}};
    unsigned slices = 0;
  };

  const sim::VirtualRing& ring_;
  bool kept_ = false;
  std::vector<RecordedStep> steps_;
  std::array<std::vector<AtInstant>, 2> leaving_;  ///< by line and node
};

}  // namespace limb_ring::study
