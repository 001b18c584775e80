#include "bench/suite.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

#include "bench/cores.h"
#include "bench/cpu_to_cpu.h"
#include "bench/idle_share.h"
#include "bench/packet_observer.h"
#include "bench/private_ring.h"
#include "bench/reference_ring.h"
#include "bench/relay_chain.h"
#include "bench/ring_judge.h"
#include "bench/ring_traffic.h"
#include "bench/write_ring.h"
#include "config/key_file.h"

namespace limb_ring::bench {
namespace {

constexpr Pinning kPinnings[] = {Pinning::one_core, Pinning::free};
constexpr unsigned kVirtualRates[] = {100, 1000};  // Hz
constexpr Sending kSendings[] = {Sending::one, Sending::all};

std::string words(Pinning pinning) { return pinning == Pinning::one_core ? "one core" : "unpinned"; }
std::string words(Sending sending) { return sending == Sending::one ? "one sender" : "all sending"; }

/// A plain ring with a section `realtime`. @return the file's path
std::string write_realtime(const live::PrivateFolder& folder, unsigned nodes, const std::string& realtime) {
  const std::string path = folder.path() + "/realtime " + std::to_string(nodes) + realtime + ".yaml";
  return write_ring(path, nodes, "realtime: " + realtime + '\n');
}

/// A plain ring whose UDP lines are keyed. @return the file's path
std::string write_keyed(const live::PrivateFolder& folder, unsigned nodes, const std::string& name) {
  const std::string key = folder.path() + '/' + name + ".key";
  config::make_key_file(key);
  return write_ring(folder.path() + '/' + name + " keyed.yaml", nodes, "links: {key: '" + key + "'}\n");
}

/// How many nodes can have a core each; 0: this machine has too few cores.
unsigned spin_nodes(const Setup& setup) {
  const unsigned nodes = std::min(core_count(), setup.nodes);
  return nodes < 2 ? 0 : nodes;
}

/// The rounds of one case.
struct Case {
  std::vector<Measurement> rounds;
  std::vector<double> ratios;
  std::vector<double> additions;  ///< ratios by the same ring without what this one has in addition
};

/// Measures everything at one pinning, round by round.
class Rounds {
 public:
  Rounds(const Setup& setup, const live::PrivateFolder& folder, Pinning pinning)
      : setup_(setup), folder_(folder), pinning_(pinning) {}

  void run() {
    const std::string two_cpus = write_two_cpus(setup_, folder_);
    const std::string keyed = write_keyed(folder_, setup_.nodes, words(pinning_));
    for (unsigned round = 1; round <= setup_.rounds; ++round) {
      where_ = words(pinning_) + ", round " + std::to_string(round) + " of " + std::to_string(setup_.rounds);
      ring("unix", {"", "unix", pinning_});
      ring("shm", {"", "shm", pinning_});
      ring("udp", {"", "udp", pinning_});
      ring("keyed", {keyed, "udp", pinning_});
      if (setup_.wants("cpu_to_cpu")) cpu_to_cpu({two_cpus, "", pinning_});
      if (setup_.wants("judged")) judged(round % 2 == 1);
      if (setup_.wants("recorded") && pinning_ == Pinning::one_core) recorded(round % 2 == 1);
      if (pinning_ == Pinning::one_core) {
        ring("batch", {write_realtime(folder_, setup_.nodes, "{batch: true}"), "shm", pinning_});
        continue;
      }
      ring("placed", {write_realtime(folder_, setup_.nodes, "{cores: auto, fifo: 10}"), "shm", pinning_});
      if (setup_.wants("spin") && spin_nodes(setup_) != 0) spin();
    }
  }

  void add_rows(std::vector<Row>& rows) const {
    for (const auto& [key, measured] : cases_)
      rows.push_back({key.first, pinning_, key.second, of_rounds(measured.rounds), median(measured.ratios),
                      measured.additions.empty() ? 0 : median(measured.additions)});
  }

 private:
  void ring(const std::string& what, const RingRequest& request) {
    if (!setup_.wants(what)) return;
    std::map<Sending, double> reference;
    for (const Sending sending : kSendings) reference[sending] = measure_reference_p50(sending);
    const PrivateRing ring(setup_, request);
    for (const Sending sending : kSendings) {
      tell(what, sending);
      const Measurement measured = measure_traffic(setup_, ring, sending);
      add(what, sending, measured, reference[sending]);
      if (what == "udp") udp_p50_[sending] = measured.round_trip_us.p50;
      if (what == "keyed" && setup_.wants("udp"))
        cases_[{what, sending}].additions.push_back(measured.round_trip_us.p50 / udp_p50_[sending]);
      if (what == "unix") watched(ring, sending, measured, reference[sending]);
    }
  }

  /// The same again while a dump reads all that one node sees: what that costs.
  void watched(const PrivateRing& ring, Sending sending, const Measurement& unwatched, double reference) {
    tell("watched", sending);
    const PacketObserver observer(setup_, ring, 0, pinning_);
    const Measurement measured = measure_traffic(setup_, ring, sending);
    add("watched", sending, measured, reference);
    cases_[{"watched", sending}].additions.push_back(measured.round_trip_us.p50 / unwatched.round_trip_us.p50);
  }

  /// A ring with every node's flight recorder on beside one without, in turns: what that costs.
  void recorded(bool first) {
    const double reference = measure_reference_p50(Sending::all);
    std::map<bool, Measurement> measured;
    for (const bool record : {first, !first}) {
      const PrivateRing ring(setup_, {"", "shm", pinning_, record});
      tell(record ? "recorded" : "not recorded", Sending::all);
      measured[record] = measure_traffic(setup_, ring, Sending::all);
    }
    add("recorded", Sending::all, measured[true], reference);
    cases_[{"recorded", Sending::all}].additions.push_back(measured[true].round_trip_us.p50 /
                                                           measured[false].round_trip_us.p50);
  }

  /// A ring whose promises are judged meanwhile, and the same while they are not, in turns: what that costs.
  void judged(bool first) {
    const double reference = measure_reference_p50(Sending::all);
    const PrivateRing ring(setup_, {"", "shm", pinning_});
    std::map<bool, Measurement> measured;
    for (const bool judge : {first, !first}) {
      std::optional<RingJudge> at_work;
      if (judge) at_work.emplace(setup_, ring, pinning_);
      tell(judge ? "judged" : "not judged", Sending::all);
      measured[judge] = measure_traffic(setup_, ring, Sending::all);
      if (judge) at_work->require_kept();
    }
    add("judged", Sending::all, measured[true], reference);
    cases_[{"judged", Sending::all}].additions.push_back(measured[true].round_trip_us.p50 /
                                                         measured[false].round_trip_us.p50);
  }

  void cpu_to_cpu(const RingRequest& request) {
    const double reference = measure_reference_p50(Sending::one);
    const PrivateRing ring(setup_, request);
    tell("cpu_to_cpu", Sending::one);
    add("cpu_to_cpu", Sending::one, measure_cpu_to_cpu(setup_, ring, pinning_), reference);
  }

  void spin() {
    Setup few = setup_;
    few.nodes = spin_nodes(setup_);
    tell("spin_reference", Sending::one);
    const Measurement reference = measure_reference(few, pinning_, Sending::one);
    add("spin_reference", Sending::one, reference, reference.round_trip_us.p50);
    const std::string config = write_realtime(folder_, few.nodes, "{cores: auto, spin: 50us}");
    const PrivateRing ring(few, {config, "shm", pinning_});
    tell("spin", Sending::one);
    add("spin", Sending::one, measure_traffic(few, ring, Sending::one), reference.round_trip_us.p50);
  }

  double measure_reference_p50(Sending sending) {
    tell("reference", sending);
    const Measurement measured = measure_reference(setup_, pinning_, sending);
    add("reference", sending, measured, measured.round_trip_us.p50);
    return measured.round_trip_us.p50;
  }

  void add(const std::string& what, Sending sending, const Measurement& measured, double reference_p50) {
    Case& all = cases_[{what, sending}];
    all.rounds.push_back(measured);
    all.ratios.push_back(measured.round_trip_us.p50 / reference_p50);
  }

  void tell(const std::string& what, Sending sending) const {
    setup_.tell(where_ + ": " + what + ", " + words(sending));
  }

  const Setup& setup_;
  const live::PrivateFolder& folder_;
  Pinning pinning_;
  std::string where_;
  std::map<std::pair<std::string, Sending>, Case> cases_;
  std::map<Sending, double> udp_p50_;  ///< of this round
};

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

const Row* Report::find(const std::string& what, Pinning pinning, Sending sending) const {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& row) {
    return row.what == what && row.pinning == pinning && row.sending == sending;
  });
  return found == rows.end() ? nullptr : &*found;
}

std::uint64_t Report::failed() const {
  return std::accumulate(rows.begin(), rows.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const Row& row) { return sum + row.measured.failed; });
}

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
    rounds.add_rows(report.rows);
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
