#pragma once

#include <algorithm>
#include <string>

#include "limb_ring/host_port.h"

namespace limb_ring::bridge {

/// An outcome as one word, for counters and messages: "no_such_node".
inline std::string outcome_word(std::string outcome) {
  std::replace(outcome.begin(), outcome.end(), ' ', '_');
  return outcome;
}
inline std::string outcome_word(Outcome outcome) { return outcome_word(to_string(outcome)); }

}  // namespace limb_ring::bridge
