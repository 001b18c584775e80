#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/measurement.h"
#include "bench/own_rate.h"
#include "bench/setup.h"
#include "bench/system_costs.h"
#include "bench/virtual_rate.h"

namespace limb_ring::bench {

/// One thing measured in every way, beside the reference of the same rounds.
struct Row {
  /// reference, unix, shm, watched, recorded, judged, udp, keyed, cpu_to_cpu, placed, spin_reference, spin, relay_chain
  std::string what;
  Pinning pinning = Pinning::one_core;
  Sending sending = Sending::one;
  Measurement measured;
  double reference_ratio = 1;  ///< p50 by the reference's, pinned and sending alike: median of rounds
  double addition_ratio = 0;   ///< watched, recorded, judged, keyed: the same by the ring's without that; else 0
};

struct Report {
  unsigned nodes = 0;
  std::size_t payload = 0;
  double seconds = 0;
  unsigned spin_nodes = 0;  ///< in the rings of spin and spin_reference: a core for each; 0: not measured
  std::vector<Row> rows;
  std::string relay_chain_skipped;           ///< why; empty where it was measured
  std::optional<double> idle_plain_percent;  ///< of one core, all processes together
  std::optional<double> idle_humanoid_percent;
  std::optional<OwnRate> own_rate;
  std::string own_rate_skipped;            ///< why; empty where it was measured, or not wanted
  std::vector<VirtualRate> virtual_rates;  ///< none where there is no humanoid
  SystemCosts costs;

  const Row* find(const std::string& what, Pinning pinning, Sending sending) const;
  std::uint64_t failed() const;  ///< packets of all rows together
};

}  // namespace limb_ring::bench
