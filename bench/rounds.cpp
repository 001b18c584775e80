#include "bench/rounds.h"

#include <algorithm>
#include <optional>

#include "bench/cores.h"
#include "bench/cpu_to_cpu.h"
#include "bench/private_ring.h"
#include "bench/ring_traffic.h"
#include "node/link_settings.h"

namespace limb_ring::bench {
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

}  // namespace limb_ring::bench
