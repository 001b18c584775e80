#include "bench/suite.h"

#include <vector>

#include "bench/idle_share.h"
#include "bench/private_ring.h"
#include "bench/reference_ring.h"
#include "bench/relay_chain.h"
#include "bench/rounds.h"

namespace limb_ring::bench {
namespace {

constexpr Pinning kPinnings[] = {Pinning::one_core, Pinning::free};
constexpr unsigned kVirtualRates[] = {100, 1000};  // Hz

void add_relay_chain(const Setup& setup, const live::PrivateFolder& folder, Report& report) {
  for (const Pinning pinning : kPinnings) {
    setup.tell("chain of topic_tools/relay, " + words(pinning));
    const RelayChainResult result = measure_relay_chain(setup, folder, pinning);
    report.relay_chain_skipped = result.skipped;
    if (!result.skipped.empty()) return;
    const Row* measured = report.find("reference", pinning, Sending::one);
    const Measurement reference = measured ? measured->measured : measure_reference(setup, pinning, Sending::one);
    const double ratio = result.measured.round_trip_us.p50 / reference.round_trip_us.p50;
    report.rows.push_back({"relay_chain", pinning, Sending::one, result.measured, ratio, 0});
  }
}

double idle_percent(const Setup& setup, const std::string& config) {
  setup.tell("idle ring " + (config.empty() ? "without CPUs" : "of " + config));
  PrivateRing ring(setup, {config, "", Pinning::free});
  return measure_idle_percent(setup, ring);
}

void add_own_rate(const Setup& setup, const live::PrivateFolder& folder, Report& report) {
  const OwnRateResult own_rate = measure_own_rate(setup, folder);
  report.own_rate_skipped = own_rate.skipped;
  if (own_rate.skipped.empty()) report.own_rate = own_rate.measured;
}

}  // namespace

Report run_suite(const Setup& setup, const live::PrivateFolder& folder) {
  Report report;
  report.nodes = setup.nodes;
  report.payload = setup.payload;
  report.seconds = setup.seconds;
  report.spin_nodes = setup.wants("spin") ? spin_nodes(setup) : 0;
  report.costs = measure_system_costs();
  for (const Pinning pinning : kPinnings) {
    Rounds rounds(setup, folder, pinning);
    rounds.run();
    const std::vector<Row> rows = rounds.rows();
    report.rows.insert(report.rows.end(), rows.begin(), rows.end());
  }
  const bool humanoid = !setup.humanoid.empty();
  if (setup.wants("relay_chain")) add_relay_chain(setup, folder, report);
  if (setup.wants("idle")) report.idle_plain_percent = idle_percent(setup, "");
  if (setup.wants("idle") && humanoid) report.idle_humanoid_percent = idle_percent(setup, setup.humanoid);
  if (setup.wants("humanoid_1khz")) add_own_rate(setup, folder, report);
  for (const unsigned rate : kVirtualRates)
    if (setup.wants("humanoid_virtual") && humanoid)
      report.virtual_rates.push_back(measure_virtual_rate(setup, folder, rate));
  return report;
}

}  // namespace limb_ring::bench
