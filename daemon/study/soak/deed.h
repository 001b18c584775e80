#pragma once

#include <variant>

#include "scenario/scenario.h"

namespace limb_ring::study {

/// Something that was done to a ring, in the words of scenarios, with its instant. Nodes are ids.
struct Deed {
  core::Time at{};
  std::variant<fault::Fault, scenario::Send, scenario::SoakAction> what;
};

}  // namespace limb_ring::study
