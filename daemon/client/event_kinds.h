#pragma once

#include <string>
#include <vector>

namespace limb_ring::client {

/// All kinds of events that a daemon tells its observers, as an observe filter names them. See "Observing" in
/// docs/reference/requests.md.
const std::vector<std::string>& event_kinds();

}  // namespace limb_ring::client
