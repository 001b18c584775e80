#include "bench/suite.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "bench/measurement.h"
#include "bench/private_ring.h"
#include "bench/relay_chain.h"
#include "bench/ring_traffic.h"
#include "bench/setup.h"
#include "node/link_settings.h"
#include "ring/launched_ring.h"

namespace limb_ring::bench {

/// "one core", "unpinned"
std::string words(Pinning pinning);

/// Measures all rings at one pinning, round by round, each beside the reference.
class Rounds {
 public:
  /// Setup and folder outlive this.
  Rounds(const Setup& setup, const live::PrivateFolder& folder, Pinning pinning);

  void run();
  std::vector<Row> rows() const { return cases_.rows(pinning_); }

 private:
  /// Files of rings, which all rounds have in common.
  struct Files {
    std::string two_cpus, keyed;
  };

  void run_round(const Files& files, bool odd);
  void ring(const std::string& what, const RingRequest& request);
  /// The same again while a dump reads all that one node sees: what that costs.
  void watched(const PrivateRing& ring, Sending sending, const Measurement& unwatched, double reference);
  /// A ring with every node's flight recorder on beside one without, in turns: what that costs.
  /// @param first with it
  void recorded(bool first);
  /// A ring with somebody at work beside it, and the same without, in turns: what that costs.
  /// @tparam AtWork RingJudge, RingLook @param first with it
  template <typename AtWork>
  void beside(const std::string& what, bool first);
  void cpu_to_cpu(const std::string& two_cpus);
  void spin();
  double measure_reference_p50(Sending sending);
  void tell(const std::string& what, Sending sending) const;

  const Setup& setup_;
  const live::PrivateFolder& folder_;
  Pinning pinning_;
  std::string where_;
  Cases cases_;
  std::map<Sending, Measurement> udp_;  ///< of this round
};

namespace {

constexpr Sending kSendings[] = {Sending::one, Sending::all};

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

}  // namespace

/// How many nodes can have a core each; 0: this machine has too few cores.
unsigned spin_nodes(const Setup& setup) {
  const unsigned nodes = std::min(core_count(), setup.nodes);
  return nodes < 2 ? 0 : nodes;
}

std::string words(Pinning pinning) { return pinning == Pinning::one_core ? "one core" : "unpinned"; }

Rounds::Rounds(const Setup& setup, const live::PrivateFolder& folder, Pinning pinning)
    : setup_(setup), folder_(folder), pinning_(pinning) {}

void Rounds::run() {
  const Files files{write_two_cpus(setup_, folder_), write_keyed(folder_, setup_.nodes, words(pinning_))};
  for (unsigned round = 1; round <= setup_.rounds; ++round) {
    where_ = words(pinning_) + ", round " + std::to_string(round) + " of " + std::to_string(setup_.rounds);
    run_round(files, round % 2 == 1);
  }
}

void Rounds::run_round(const Files& files, bool odd) {
  ring("unix", {"", "unix", pinning_});
  ring("shm", {"", "shm", pinning_});
  ring("udp", {"", "udp", pinning_});
  ring("keyed", {files.keyed, "udp", pinning_});
  if (setup_.wants("cpu_to_cpu")) cpu_to_cpu(files.two_cpus);
  beside<RingJudge>("judged", odd);
  beside<RingLook>("viewed", odd);
  if (pinning_ == Pinning::one_core) {
    if (setup_.wants("recorded")) recorded(odd);
  } else {
    ring("placed", {write_realtime(folder_, setup_.nodes, "{cores: auto, fifo: 10}"), "shm", pinning_});
    if (setup_.wants("spin") && spin_nodes(setup_) != 0) spin();
  }
}

void Rounds::ring(const std::string& what, const RingRequest& request) {
  if (!setup_.wants(what)) return;
  std::map<Sending, double> reference;
  for (const Sending sending : kSendings) reference[sending] = measure_reference_p50(sending);
  const PrivateRing ring(setup_, request);
  for (const Sending sending : kSendings) {
    tell(what, sending);
    const Measurement measured = measure_traffic(setup_, ring, sending);
    cases_.add(what, sending, measured, reference[sending]);
    if (what == "udp") udp_[sending] = measured;
    if (what == "keyed" && setup_.wants("udp")) cases_.add_without("keyed", sending, udp_[sending]);
    if (what == "unix") watched(ring, sending, measured, reference[sending]);
  }
}

void Rounds::watched(const PrivateRing& ring, Sending sending, const Measurement& unwatched, double reference) {
  tell("watched", sending);
  const PacketObserver observer(setup_, ring, 0, pinning_);
  cases_.add("watched", sending, measure_traffic(setup_, ring, sending), reference);
  cases_.add_without("watched", sending, unwatched);
}

void Rounds::recorded(bool first) {
  const double reference = measure_reference_p50(Sending::all);
  std::map<bool, Measurement> measured;
  for (const bool record : {first, !first}) {
    const PrivateRing ring(setup_, {"", "shm", pinning_, record});
    tell(record ? "recorded" : "not recorded", Sending::all);
    measured[record] = measure_traffic(setup_, ring, Sending::all);
  }
  cases_.add("recorded", Sending::all, measured[true], reference);
  cases_.add_without("recorded", Sending::all, measured[false]);
}

template <typename AtWork>
void Rounds::beside(const std::string& what, bool first) {
  if (!setup_.wants(what)) return;
  const double reference = measure_reference_p50(Sending::all);
  const PrivateRing ring(setup_, {"", "shm", pinning_});
  std::map<bool, Measurement> measured;
  for (const bool with : {first, !first}) {
    std::optional<AtWork> at_work;
    if (with) at_work.emplace(setup_, ring, pinning_);
    tell((with ? "" : "not ") + what, Sending::all);
    measured[with] = measure_traffic(setup_, ring, Sending::all);
    if (with) at_work->require_valid();
  }
  cases_.add(what, Sending::all, measured[true], reference);
  cases_.add_without(what, Sending::all, measured[false]);
}

void Rounds::cpu_to_cpu(const std::string& two_cpus) {
  const double reference = measure_reference_p50(Sending::one);
  const PrivateRing ring(setup_, {two_cpus, "", pinning_});
  tell("cpu_to_cpu", Sending::one);
  cases_.add("cpu_to_cpu", Sending::one, measure_cpu_to_cpu(setup_, ring, pinning_), reference);
}

void Rounds::spin() {
  Setup few = setup_;
  few.nodes = spin_nodes(setup_);
  tell("spin_reference", Sending::one);
  const Measurement reference = measure_reference(few, pinning_, Sending::one);
  cases_.add("spin_reference", Sending::one, reference, reference.round_trip_us.p50);
  const std::string config = write_realtime(folder_, few.nodes, "{cores: auto, spin: 50us}");
  const PrivateRing ring(few, {config, "shm", pinning_});
  tell("spin", Sending::one);
  cases_.add("spin", Sending::one, measure_traffic(few, ring, Sending::one), reference.round_trip_us.p50);
}

double Rounds::measure_reference_p50(Sending sending) {
  tell("reference", sending);
  const Measurement measured = measure_reference(setup_, pinning_, sending);
  cases_.add("reference", sending, measured, measured.round_trip_us.p50);
  return measured.round_trip_us.p50;
}

void Rounds::tell(const std::string& what, Sending sending) const {
  setup_.tell(where_ + ": " + what + ", " + words(sending));
}

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

namespace {

using nlohmann::json;

const char* key_of(Pinning pinning) { return pinning == Pinning::one_core ? "one_core" : "unpinned"; }
const char* key_of(Sending sending) { return sending == Sending::one ? "one_sender" : "all_sending"; }

/// Two decimals: more would be noise.
double rounded(double value) { return std::round(value * 100) / 100; }
/// Finer: a reference that was kept waiting on a busy machine makes a ratio small, and it is not 0.
double rounded_ratio(double value) { return std::round(value * 1e6) / 1e6; }

json row_json(const Row& row) {
  const RoundTrip& time = row.measured.round_trip_us;
  json all{{"round_trip_us", {{"p50", rounded(time.p50)}, {"p99", rounded(time.p99)}, {"max", rounded(time.max)}}},
           {"packets_per_second", rounded(row.measured.packets_per_second)},
           {"reference_ratio", rounded_ratio(row.reference_ratio)},
           {"packets", row.measured.packets},
           {"failed", row.measured.failed}};
  if (row.addition_ratio > 0) all["un" + row.what + "_ratio"] = rounded_ratio(row.addition_ratio);
  return all;
}

json own_rate_json(const Report& report) {
  if (!report.own_rate) return report.own_rate_skipped.empty() ? json() : json{{"skipped", report.own_rate_skipped}};
  const OwnRate& rate = *report.own_rate;
  return {{"joint_states_rate", rounded(rate.joint_states_rate)},
          {"commands_rate", rounded(rate.commands_rate)},
          {"samples", rate.samples},
          {"left_out", rate.left_out},
          {"lap_us", {{"p50", rounded(rate.lap_p50_us)}, {"p99", rounded(rate.lap_p99_us)}}},
          {"cpu_percent", rounded(rate.ring_percent)}};
}

json virtual_rate_json(const VirtualRate& rate) {
  return {{"state_rate", rate.state_rate},
          {"samples", rate.samples},
          {"left_out", rate.left_out},
          {"times_real_time", rounded(rate.times_real_time)}};
}

json percent(const std::optional<double>& value) { return value ? json(rounded(*value)) : json(); }

struct Label {
  const char* what;  ///< as in Row
  const char* text;
};

/// All that is measured at a pinning, in the order in which it is printed.
constexpr Label kLabels[] = {{"reference", "bare reference ring (UNIX)"},
                             {"shm", "limb_ring through shared memory"},
                             {"recorded", "  with flight recorders"},
                             {"judged", "  while its promises are judged"},
                             {"viewed", "  while a browser looks"},
                             {"placed", "  cores: auto, fifo"},
                             {"unix", "limb_ring over UNIX stream"},
                             {"watched", "  while one dump reads along"},
                             {"udp", "limb_ring over UDP"},
                             {"keyed", "  keyed (links.key)"},
                             {"cpu_to_cpu", "limb_ring, CPU to CPU and back"},
                             {"relay_chain", "chain of topic_tools/relay"}};

/// The same of the rings that have a core for each node.
constexpr Label kSpinLabels[] = {{"spin_reference", "bare reference ring (UNIX)"},
                                 {"spin", "shared memory, spin: 50us"}};

void print_line(std::ostream& out, const char* label, const Row& row) {
  const RoundTrip& time = row.measured.round_trip_us;
  out << "  " << std::left << std::setw(32) << label << std::right << std::setw(9) << time.p50 << std::setw(9)
      << time.p99 << std::setw(10) << time.max << std::setw(11) << std::setprecision(0)
      << row.measured.packets_per_second << std::setprecision(2) << std::setw(8) << row.reference_ratio << "x";
  if (row.addition_ratio > 0) out << "  (" << row.addition_ratio << "x un" << row.what << ")";
  if (row.measured.failed != 0) out << "  " << row.measured.failed << " FAILED";
  out << std::setprecision(1) << '\n';
}

void print_table(std::ostream& out, const Report& report, Pinning pinning, Sending sending) {
  const bool measured = std::any_of(report.rows.begin(), report.rows.end(), [=](const Row& row) {
    return row.pinning == pinning && row.sending == sending && row.what.rfind("spin", 0) != 0;
  });
  if (!measured) return;
  out << (sending == Sending::one ? "one sender, " : "all sending, ")
      << (pinning == Pinning::one_core ? "all processes on one core" : "unpinned") << '\n';
  for (const Label& label : kLabels)
    if (const Row* row = report.find(label.what, pinning, sending)) print_line(out, label.text, *row);
}

void print_spin(std::ostream& out, const Report& report) {
  if (report.spin_nodes == 0) return;
  out << "one sender, " << report.spin_nodes << " nodes, a core for each\n";
  for (const Label& label : kSpinLabels)
    print_line(out, label.text, *report.find(label.what, Pinning::free, Sending::one));
}

void print_idle(std::ostream& out, const char* ring, const std::optional<double>& share) {
  if (share) out << "  " << std::left << std::setw(32) << ring << std::right << std::setw(9) << *share << " %\n";
}

void print_own_rate(std::ostream& out, const Report& report) {
  if (!report.own_rate && report.own_rate_skipped.empty()) return;
  out << "humanoid16 at 1 kHz, states and commands of all joints, ring_bridge at 1 kHz\n";
  if (!report.own_rate) {
    out << "  skipped, " << report.own_rate_skipped << '\n';
    return;
  }
  const OwnRate& rate = *report.own_rate;
  out << "  " << rate.samples << " samples, " << rate.left_out << " left out; joint_states " << rate.joint_states_rate
      << " Hz; commands at each node " << rate.commands_rate << " Hz; lap p50 " << rate.lap_p50_us << " us, p99 "
      << rate.lap_p99_us << " us; ring and bridge take " << rate.ring_percent << " % of a core\n";
}

void print_virtual_rates(std::ostream& out, const Report& report) {
  if (report.virtual_rates.empty()) return;
  out << "humanoid16 with firmware and a controller on a virtual clock, one core, states and commands of all joints\n";
  for (const VirtualRate& rate : report.virtual_rates)
    out << "  at " << rate.state_rate << " Hz: " << rate.samples << " samples, " << rate.left_out << " left out, "
        << rate.times_real_time << " times real time\n";
}

}  // namespace

json to_json(const Report& report) {
  json all = {{"nodes", report.nodes}, {"payload", report.payload}, {"seconds_per_case", report.seconds}};
  all["failed"] = report.failed();
  for (const Row& row : report.rows) {
    all[row.what][key_of(row.pinning)][key_of(row.sending)] = row_json(row);
    if (row.what == "unix" && row.pinning == Pinning::one_core) all[key_of(row.sending)] = row_json(row);
  }
  if (!report.relay_chain_skipped.empty()) all["relay_chain"] = {{"skipped", report.relay_chain_skipped}};
  all["idle_cpu_percent"] = {{"plain", percent(report.idle_plain_percent)},
                             {"humanoid16", percent(report.idle_humanoid_percent)}};
  all["system_call_us"] = rounded(report.costs.system_call);
  all["process_switch_us"] = rounded(report.costs.process_switch);
  all["spin_nodes"] = report.spin_nodes;
  all["humanoid_1khz"] = own_rate_json(report);
  all["humanoid_virtual"] = json::array();
  for (const VirtualRate& rate : report.virtual_rates) all["humanoid_virtual"].push_back(virtual_rate_json(rate));
  return all;
}

std::string to_text(const Report& report) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(1);
  out << report.nodes << " nodes, " << report.payload << " bytes of payload, round trips in us\n\n";
  out << std::setw(43) << "p50" << std::setw(9) << "p99" << std::setw(10) << "max" << std::setw(11) << "packets/s"
      << "  reference\n";
  for (const Pinning pinning : {Pinning::one_core, Pinning::free})
    for (const Sending sending : {Sending::one, Sending::all}) print_table(out, report, pinning, sending);
  print_spin(out, report);
  if (!report.relay_chain_skipped.empty())
    out << "chain of topic_tools/relay: skipped, " << report.relay_chain_skipped << '\n';
  if (report.idle_plain_percent) out << "idle rings, CPU of all processes together, of one core\n";
  print_idle(out, "plain ring", report.idle_plain_percent);
  print_idle(out, "humanoid16 with its CPUs", report.idle_humanoid_percent);
  print_own_rate(out, report);
  print_virtual_rates(out, report);
  out << std::setprecision(2) << "here a system call takes " << report.costs.system_call
      << " us; a switch to another process, with two of them, " << report.costs.process_switch << " us\n";
  return out.str();
}

void Cases::add(const std::string& what, Sending sending, const Measurement& measured, double reference_p50) {
  Case& all = cases_[{what, sending}];
  all.rounds.push_back(measured);
  all.ratios.push_back(measured.round_trip_us.p50 / reference_p50);
}

void Cases::add_without(const std::string& what, Sending sending, const Measurement& without) {
  Case& all = cases_.at({what, sending});
  all.additions.push_back(all.rounds.back().round_trip_us.p50 / without.round_trip_us.p50);
}

std::vector<Row> Cases::rows(Pinning pinning) const {
  std::vector<Row> rows;
  for (const auto& [key, measured] : cases_) {
    const double addition = measured.additions.empty() ? 0 : median(measured.additions);
    rows.push_back({key.first, pinning, key.second, of_rounds(measured.rounds), median(measured.ratios), addition});
  }
  return rows;
}

}  // namespace limb_ring::bench
