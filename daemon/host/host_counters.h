#pragma once

#include <cstdint>

namespace limb_ring::host {

/// What happened at a host port; every loss has its counter.
struct HostCounters {
  std::uint64_t attached = 0;         ///< clients that were let in
  std::uint64_t refused = 0;          ///< by the handler, a wrong ring or version, a second CPU
  std::uint64_t refused_foreign = 0;  ///< another user's process
  std::uint64_t refused_full = 0;     ///< more clients than limits.clients
  std::uint64_t garbage = 0;          ///< closed for bytes that are no message
  std::uint64_t never_greeted = 0;    ///< closed for not greeting in time
  std::uint64_t slow_clients = 0;     ///< closed for not reading what was for them
  std::uint64_t observed_lost = 0;    ///< Observed left out for observers that read too slowly
  std::uint64_t captured_lost = 0;    ///< captured packets left out for observers that read too slowly
  std::uint64_t rejected = 0;         ///< calls with bad arguments
  std::uint64_t interrupts_lost = 0;  ///< interrupts for a CPU that was not attached
};

}  // namespace limb_ring::host
