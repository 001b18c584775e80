#pragma once

#include <optional>
#include <set>
#include <string>

#include "config/ring_config.h"
#include "wire/selection.h"

namespace limb_ring::runtime {

/// What a client wants to observe; see "Observing" in docs/reference/requests.md.
struct ObserveFilter {
  std::set<std::string> kinds;             ///< of events; empty: none
  std::optional<capture::Choice> packets;  ///< nothing: none
  bool promises = false;                   ///< all that judging the ring's promises needs
};

/// @throw std::runtime_error naming what is wrong, and what is allowed
ObserveFilter read_observe_filter(const config::RingConfig& ring, const std::string& text);

}  // namespace limb_ring::runtime
