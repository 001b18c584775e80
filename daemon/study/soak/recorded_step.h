#pragma once

#include <variant>

#include "scenario/scenario.h"

namespace limb_ring::study {

/// One thing that was done to a ring: what, in the words of scenarios, and when. Nodes are ids.
struct RecordedStep {
  core::Time at{};
  std::variant<fault::Fault, scenario::Send, scenario::SoakAction> what;
};

}  // namespace limb_ring::study
