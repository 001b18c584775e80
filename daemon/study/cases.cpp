#include "study/cases.h"

#include <functional>
#include <optional>
#include <random>

#include "study/model_ring.h"

namespace limb_ring::study {
namespace {

using core::SendEnded;

constexpr NodeId kFirst{0};

/// One case as it runs: the ring, and what it has measured.
struct Run {
  const Medium& medium;
  CaseRing& ring;
  CaseResult& result;
  std::mt19937_64 random;

  unsigned nodes() const { return medium.nodes; }
  Duration T() const { return medium.byte_time() * static_cast<std::int64_t>(medium.payload + wire::kOverhead); }
  Duration d() const { return medium.relay_delay; }
  Duration interrupt() const { return medium.byte_time() * static_cast<std::int64_t>(wire::kInterruptPacketSize); }
  int n() const { return static_cast<int>(medium.nodes); }

  Duration below(Duration limit) {
    return Duration{static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(limit.count()))};
  }
  std::uint32_t send(NodeId from, NodeId to) {
    return ring.send(from, to, std::vector<std::uint8_t>(medium.payload, from));
  }
  /// The worst case: each node starts a packet of its own at the instant at which the one that left node 0 at `start`
  /// arrives there.
  void send_in_front(Time start) {
    for (unsigned id = 1; id < medium.nodes; ++id)
      ring.at(start + d() * id + T() * (id - 1), [this, id] { send(static_cast<NodeId>(id), kFirst); });
  }
  /// Runs until that many sends have ended.
  void run_until_ended(unsigned count) {
    ring.run_until([&] { return ended >= count; }, 100 * ring.settings(kFirst).worst_lap());
    ring.check();
    if (ended < count) throw std::runtime_error("a packet did not come home");
  }
  unsigned ended = 0;
};

Duration simultaneous_time(const Run& run) {
  return run.T() >= run.d() ? run.T() * run.n() + run.d() : run.T() + run.d() * run.n();
}

/// The round trips of all packets of the nodes in question.
void measure(Run& run, const std::function<bool(NodeId, const SendEnded&)>& counts) {
  run.ring.on_event = [&run, counts](NodeId node, const core::Event& event) {
    const auto* end = std::get_if<SendEnded>(&event.what);
    if (!end) return;
    ++run.ended;
    if (counts(node, *end)) run.result.measured.add(end->round_trip);
  };
}

void alone(Run& run) {
  run.result.formula = run.T() + run.d() * run.n();
  measure(run, [](NodeId, const SendEnded&) { return true; });
  run.send(kFirst, static_cast<NodeId>(run.nodes() / 2));
  run.run_until_ended(1);
}

void simultaneous(Run& run) {
  run.result.formula = simultaneous_time(run);
  measure(run, [](NodeId, const SendEnded&) { return true; });
  for (NodeId id{0}; id < run.nodes(); ++id) run.send(id, static_cast<NodeId>((id + run.nodes() / 2) % run.nodes()));
  run.run_until_ended(run.nodes());
}

void adversarial(Run& run) {
  run.result.formula = (run.T() + run.d()) * run.n();
  measure(run, [](NodeId node, const SendEnded&) { return node == 0; });
  run.send(kFirst, static_cast<NodeId>(run.nodes() / 2));
  run.send_in_front(run.ring.now());
  run.run_until_ended(run.nodes());
}

// The last node's packet begins to pass node 0. One picosecond later, the CPU of node 0 asks for its send.
void request(Run& run) {
  run.result.formula = run.T() * (run.n() + 1) + run.d() * run.n();
  const Time asked = run.ring.now() + run.d() + Duration{1};
  run.ring.on_event = [&run, asked](NodeId node, const core::Event& event) {
    if (!std::holds_alternative<SendEnded>(event.what)) return;
    ++run.ended;
    if (node == 0) run.result.measured.add(event.at - asked);
  };
  run.send(static_cast<NodeId>(run.nodes() - 1), kFirst);
  run.ring.at(asked, [&run] { run.send(kFirst, static_cast<NodeId>(run.nodes() / 2)); });
  run.send_in_front(run.ring.now() + run.d() + run.T());
  run.run_until_ended(run.nodes() + 1u);
}

void delivery(Run& run) {
  const auto last = static_cast<NodeId>(run.nodes() - 1);
  run.result.formula = (run.T() + run.d()) * last;
  measure(run, [](NodeId, const SendEnded&) { return false; });
  const Time start = run.ring.now();
  run.ring.on_packet = [&run, last, start](NodeId node, const core::ReceivedPacket& packet) {
    if (node == last && packet.source == 0) run.result.measured.add(packet.at - start);
  };
  run.send(kFirst, last);
  run.send_in_front(start);
  run.run_until_ended(run.nodes());
}

void interrupt(Run& run) {
  run.result.formula = (run.d() + run.interrupt()) * run.n();
  measure(run, [](NodeId node, const SendEnded&) { return node == 0; });
  const Time start = run.ring.now();
  run.ring.interrupt(kFirst, static_cast<NodeId>(run.nodes() / 2), 1);
  for (unsigned id = 1; id < run.nodes(); ++id)
    run.ring.at(start + run.d() * id + run.interrupt() * (id - 1),
                [&run, id] { run.ring.interrupt(static_cast<NodeId>(id), kFirst, 1); });
  run.run_until_ended(run.nodes());
}

/// Enough laps for the packets of all nodes to make some ten thousand hops.
unsigned laps(const Run& run) { return std::max(10u, 40000u / (run.nodes() * run.nodes())); }

/// Every node sends the next as the last one ends, after a pause.
void keep_sending(Run& run, const std::function<Duration()>& pause,
                  const std::function<void(NodeId, const SendEnded&)>& on_end) {
  run.ring.on_event = [&run, pause, on_end](NodeId node, const core::Event& event) {
    const auto* end = std::get_if<SendEnded>(&event.what);
    if (!end) return;
    on_end(node, *end);
    const bool is_interrupt = end->interrupt;
    const auto again = [&run, node, is_interrupt] {
      const auto to = static_cast<NodeId>((node + 1u) % run.nodes());
      is_interrupt ? run.ring.interrupt(node, to, 1) : run.send(node, to);
    };
    const Duration wait = pause();
    wait.count() == 0 ? static_cast<void>(again()) : run.ring.at(event.at + wait, again);
  };
}

void fill(Run& run, bool aligned) {
  for (NodeId id{0}; id < run.nodes(); ++id) {
    const Duration phase = aligned ? Duration{0} : run.below(run.T() * run.n());
    run.ring.at(run.ring.now() + phase, [&run, id] { run.send(id, static_cast<NodeId>((id + 1u) % run.nodes())); });
  }
}

// Over whole laps, so that the figure is exact.
void saturated(Run& run) {
  const Duration lap = simultaneous_time(run);
  run.result.has_share = true;
  run.result.formula_share = static_cast<double>((run.T() * run.n()).count()) / static_cast<double>(lap.count());
  keep_sending(
      run, [] { return Duration{0}; },
      [&run](NodeId, const SendEnded& end) { run.result.measured.add(end.round_trip); });
  fill(run, true);
  run.ring.run_for(lap * static_cast<std::int64_t>(laps(run)) - Duration{1});
  run.ring.check();
}

void saturated_at_random(Run& run) {
  run.result.formula = (run.T() + run.d()) * run.n();
  keep_sending(
      run, [] { return Duration{0}; },
      [&run](NodeId, const SendEnded& end) { run.result.measured.add(end.round_trip); });
  fill(run, false);
  run.ring.run_for((run.T() * run.n() + run.d()) * static_cast<std::int64_t>(laps(run)));
  run.ring.check();
}

void interrupts_under_load(Run& run) {
  run.result.formula = (run.d() + run.interrupt() + run.medium.byte_time() * 8) * run.n();
  const auto pause = [&run] { return run.below(run.T()); };
  keep_sending(run, pause, [&run](NodeId, const SendEnded& end) {
    if (end.interrupt) run.result.measured.add(end.round_trip);
  });
  fill(run, false);
  for (NodeId id{0}; id < run.nodes(); ++id)
    run.ring.at(run.ring.now() + pause(), [&run, id] { run.ring.interrupt(id, kFirst, 1); });
  run.ring.run_for((run.T() * run.n() + run.d()) * static_cast<std::int64_t>(laps(run)));
  run.ring.check();
}

void payload_share(Run& run) {
  const std::uint64_t data = run.ring.line_use().data_bytes();
  const std::uint64_t packets = run.ring.line_use().packet_bytes();
  saturated(run);
  run.result.formula_share = run.medium.payload / static_cast<double>(run.medium.payload + wire::kOverhead);
  run.result.measured_share = static_cast<double>(run.ring.line_use().data_bytes() - data) /
                              static_cast<double>(run.ring.line_use().packet_bytes() - packets);
}

void dispatch(Case which, Run& run) {
  switch (which) {
    case Case::alone:
      return alone(run);
    case Case::simultaneous:
      return simultaneous(run);
    case Case::adversarial:
      return adversarial(run);
    case Case::request:
      return request(run);
    case Case::delivery:
      return delivery(run);
    case Case::interrupt:
      return interrupt(run);
    case Case::interrupt_bound:
      return interrupts_under_load(run);
    case Case::saturated:
      return saturated(run);
    case Case::random:
      return saturated_at_random(run);
    case Case::payload:
      return payload_share(run);
  }
}

}  // namespace

const char* to_string(Case which) {
  switch (which) {
    case Case::alone:
      return "alone";
    case Case::simultaneous:
      return "simultaneous";
    case Case::adversarial:
      return "adversarial";
    case Case::request:
      return "request";
    case Case::delivery:
      return "delivery";
    case Case::interrupt:
      return "interrupt";
    case Case::interrupt_bound:
      return "interrupt_bound";
    case Case::saturated:
      return "saturated";
    case Case::random:
      return "random";
    case Case::payload:
      return "payload";
  }
  return "";
}

std::string formula_words(Case which, const Medium& medium) {
  const Duration T = medium.byte_time() * static_cast<std::int64_t>(medium.payload + wire::kOverhead);
  const bool short_packets = T < medium.relay_delay;
  switch (which) {
    case Case::alone:
      return "T + N d";
    case Case::simultaneous:
      return short_packets ? "T + N d" : "N T + d";
    case Case::adversarial:
      return "N (T + d)";
    case Case::request:
      return "(N + 1) T + N d";
    case Case::delivery:
      return "(N - 1) (T + d)";
    case Case::interrupt:
      return "N (d + i)";
    case Case::interrupt_bound:
      return "<= N (d + i + 8 bytes)";
    case Case::saturated:
      return short_packets ? "N T / (T + N d)" : "N T / (N T + d)";
    case Case::random:
      return "<= N (T + d)";
    case Case::payload:
      return "B / (B + 12)";
  }
  return "";
}

CaseResult run_case(Case which, const Medium& medium, std::uint64_t seed, const CaseRecords& records) {
  CaseResult result;
  CaseRing ring(medium, records.trace);
  std::optional<sim::RingCapture> captured;
  if (records.capture != nullptr)
    captured.emplace(ring, *records.capture, sim::plain_names(medium.nodes), records.capture_at);
  Pulse pulse(ring, records.goes_on);
  const std::uint64_t bytes = ring.line_use().bytes();
  Run run{medium, ring, result, std::mt19937_64(seed)};
  dispatch(which, run);
  result.occupancy = ring.occupancy(ring.zero(), bytes);
  if (which == Case::saturated) result.measured_share = result.occupancy;
  result.trace_hash = ring.trace_hash();
  return result;
}

namespace {

// Nothing is lost in a case, so nothing is to be sent again. If packets are long beside the relay delay, INTPs take
// so much of the lines that a DATP needs longer than two worst laps, which have one INTP for each node.
sim::VirtualRingOptions without_time_outs(const Medium& medium) {
  sim::VirtualRingOptions options = ring_options(medium);
  options.adjust = [usual = options.adjust](core::Settings& settings) {
    usual(settings);
    settings.send_timeout_least = settings.queue_timeout;
  };
  return options;
}

}  // namespace

CaseRing::CaseRing(const Medium& medium, std::ostream* trace)
    : sim::WatchedRing(without_time_outs(medium)), medium_(medium), trace_(*this, trace), line_use_(*this) {
  join_and_settle(*this, medium);
  zero_ = now();
}

double CaseRing::occupancy(Time since, std::uint64_t bytes) const {
  const auto used = medium_.byte_time() * static_cast<std::int64_t>(line_use_.bytes() - bytes);
  const auto all = (now() - since) * static_cast<std::int64_t>(medium_.nodes);
  return all.count() == 0 ? 0 : static_cast<double>(used.count()) / static_cast<double>(all.count());
}

}  // namespace limb_ring::study
