#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/measurement.h"
#include "bench/relay_chain.h"
#include "bench/setup.h"
#include "bench/system_costs.h"
#include "ring/launched_ring.h"

namespace limb_ring::bench {

/// One thing measured in every way, beside the reference of the same rounds.
struct Row {
  /// reference, unix, shm, watched, recorded, judged, viewed, udp, keyed, cpu_to_cpu, placed, spin_reference, spin,
  /// relay_chain
  std::string what;
  Pinning pinning = Pinning::one_core;
  Sending sending = Sending::one;
  Measurement measured;
  double reference_ratio = 1;  ///< p50 by the reference's, pinned and sending alike: median of rounds
  double addition_ratio = 0;  ///< watched, recorded, judged, viewed, keyed: the same by the ring's without that; else 0
};

struct Report {
  unsigned nodes = 0;
  std::size_t payload = 0;
  double seconds = 0;
  unsigned spin_nodes = 0;  ///< in the rings of spin and spin_reference: a core for each; 0: not measured
  std::vector<Row> rows;
  std::string relay_chain_skipped;           ///< why; empty if it was measured
  std::optional<double> idle_plain_percent;  ///< of one core, all processes together
  std::optional<double> idle_humanoid_percent;
  std::optional<OwnRate> own_rate;
  std::string own_rate_skipped;            ///< why; empty if it was measured, or not wanted
  std::vector<VirtualRate> virtual_rates;  ///< none if there is no humanoid
  SystemCosts costs;

  const Row* find(const std::string& what, Pinning pinning, Sending sending) const;
  std::uint64_t failed() const;  ///< packets of all rows together
};

/// Runs everything, or what Setup::only says. Takes about 20 times Setup::seconds. @throw std::runtime_error
Report run_suite(const Setup& setup, const live::PrivateFolder& folder);

/// {"nodes","payload","failed","one_sender","all_sending","reference","udp",...}: `one_sender` and
/// `all_sending` are the ring over UNIX stream sockets on one core. Times in microseconds.
nlohmann::json to_json(const Report& report);

/// The same side by side, for people.
std::string to_text(const Report& report);

/// What each case has given, round by round, at one pinning.
class Cases {
 public:
  /// @param reference_p50 of the same round
  void add(const std::string& what, Sending sending, const Measurement& measured, double reference_p50);
  /// Of a case that is a ring with something in addition: the same ring of the same round without that.
  void add_without(const std::string& what, Sending sending, const Measurement& without);
  /// One for each case, of all its rounds.
  std::vector<Row> rows(Pinning pinning) const;

 private:
  struct Case {
    std::vector<Measurement> rounds;
    std::vector<double> ratios;
    std::vector<double> additions;
  };
  std::map<std::pair<std::string, Sending>, Case> cases_;
};

}  // namespace limb_ring::bench
