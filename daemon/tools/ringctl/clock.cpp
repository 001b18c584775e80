#include "tools/ringctl/clock.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <thread>

#include "io/signal_wait.h"
#include "tools/common/command_line.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/status_rows.h"
#include "wire/control_message.h"

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

/// Of real time: a step takes as long as the machine and the programs do.
constexpr std::chrono::milliseconds kStepWithin{600'000};

struct ClockOptions {
  std::string ring;
  double pace = 1;
  double step_s = 0;
  bool json = false;
};

std::string seconds_of(std::int64_t ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9f s", static_cast<double>(ns) / 1e9);
  return text;
}

std::int64_t now_of(const json& state) { return state.at("now_ns").get<std::int64_t>(); }

void print(const std::string& ring, const json& state, bool as_json) {
  if (as_json)
    std::cout << state.dump(2) << '\n';
  else
    std::cout << "ring " << ring << (state.at("paused").get<bool>() ? " stands at " : " goes on from ")
              << seconds_of(now_of(state)) << ", pace " << pace_text(state.at("pace")) << '\n';
}

/// Any node of the ring, which has one clock.
HostPort clock_of(const Context& context, const ClockOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(options.ring, context.ring));
  return ring.connect(ring.source(""));
}

int ask_clock(const Context& context, const ClockOptions& options, const json& request) {
  HostPort port = clock_of(context, options);
  print(port.ring(), ask(port, request, kAnswerTime), options.json);
  return kDone;
}

struct StepInterrupted {};

// It is paused first, so that the instant is known until which it goes; and where somebody asks it to end (Ctrl-C).
int step_clock(const Context& context, const ClockOptions& options) {
  HostPort port = clock_of(context, options);
  const process::SignalWait signals;
  const std::int64_t step = std::llround(options.step_s * 1e9);
  const std::string until = seconds_of(now_of(ask(port, {{"do", "pause"}}, kAnswerTime)) + step);
  Progress progress;
  const auto tick = [&] {
    if (signals.asked_to_end(std::chrono::milliseconds(0))) throw StepInterrupted();
    progress.tell("waiting until " + until + " of the ring's time");
  };
  try {
    print(port.ring(), ask(port, {{"do", "step"}, {"time_ns", step}}, kStepWithin, tick), options.json);
    return kDone;
  } catch (const StepInterrupted&) {
    print(port.ring(), ask(port, {{"do", "pause"}}, kAnswerTime), options.json);
    throw NotDone("interrupted before " + until);
  }
}

using Act = std::function<int(const Context&, const ClockOptions&)>;

struct Words {
  const char *name, *description, *example, *more = "";
};

CLI::App* add(CLI::App& app, Context& context, const Words& words, const std::shared_ptr<ClockOptions>& options,
              const Act& act) {
  CLI::App* command = add_command(app, words.name, words.description, words.example, words.more);
  add_json(*command, options->json);
  command->callback(
      [&context, options, act] { context.action = [&context, options, act] { return act(context, *options); }; });
  return command;
}

/// Asks for that one word.
Act asking(const char* what) {
  return [what](const Context& context, const ClockOptions& options) {
    return ask_clock(context, options, {{"do", what}});
  };
}

void add_ring(CLI::App& command, ClockOptions& options) {
  command.add_option("RING", options.ring, "Name of the ring; default: as --ring");
}

int set_pace(const Context& context, const ClockOptions& options) {
  return ask_clock(context, options,
                   {{"do", "pace"}, {"pace", std::isinf(options.pace) ? json("max") : json(options.pace)}});
}

void add_time(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ClockOptions>();
  CLI::App* pace =
      add(app, context, {"pace", "Change how fast the time of a virtual ring passes", "ringctl clock pace 0.1"},
          options, set_pace);
  pace->add_option("PACE", options->pace, "Ring time per real time, 0.001 to 1000, or max: as fast as the programs can")
      ->transform(cli::pace())
      ->required();
  add_ring(*pace, *options);
  CLI::App* pause = add(app, context,
                        {"pause", "Make the time of a virtual ring stand still", "ringctl clock pause leg8",
                         "ringctl and other tools go on. What they send waits."},
                        options, asking("pause"));
  add_ring(*pause, *options);
  CLI::App* step =
      add(app, context, {"step", "Let TIME pass on a virtual ring, then stand still", "ringctl clock step 1ms"},
          options, step_clock);
  step->add_option("TIME", options->step_s,
                   "Time by the ring's clock, such as 1ms; a plain number is seconds; 1ns to 1e6 s")
      ->transform(cli::seconds(1e-9, 1e6))
      ->required();
  add_ring(*step, *options);
  CLI::App* run =
      add(app, context, {"run", "Let the time of a virtual ring go on", "ringctl clock run"}, options, asking("run"));
  add_ring(*run, *options);
}

constexpr std::chrono::milliseconds kLatchesPollPeriod{10};

constexpr const char* kSyncHelp =
    "A broadcast interrupt latches the clocks of all nodes. The offset of a node h hops downstream of the source is "
    "its "
    "latch time, less the source's, less h * round trip / ring size. Nodes on one host share a clock: their offset is "
    "how unevenly the interrupt travelled.\n"
    "One way: the time from the last node before it that latched, if the two share a clock. Of lines between hosts "
    "only "
    "the sum is known.\n"
    "Ends with 1 if a node did not latch: it is down, or has no pin wired to sync.";

struct SyncOptions {
  std::string from;
  bool json = false;
};

struct Sync {
  std::size_t source = 0;  ///< index in ring order
  std::string outcome;
  double round_trip_us = 0;
  unsigned ring_size = 0;
  std::vector<ClockOffset> offsets;
  LineDelays delays;
};

std::size_t index_of(const RingAccess& ring, std::uint8_t id) {
  std::size_t index = 0;
  while (ring.nodes()[index].id != id) ++index;
  return index;
}

using Latches = std::vector<std::optional<status::Latch>>;

/// The last latch of each node, as told by its own daemon, or for a node on another host by its beacons.
Latches last_latches(const RingAccess& ring) {
  Latches latches;
  for (const ask::Answer& answer : ask_all(ring.ring(), ring.nodes_here(), {{"do", "latch"}})) {
    status::Latch latch;
    const bool is_one = answer.said && status::read(*answer.said, latch).empty();
    latches.push_back(is_one ? std::optional(latch) : std::nullopt);
  }
  if (ring.hosts().empty()) return latches;
  Latches all;
  const Rows rows = status_rows(ring);
  for (std::size_t i = 0, here = 0; i < ring.nodes().size(); ++i) {
    if (!ring.is_elsewhere(ring.nodes()[i]))
      all.push_back(latches[here++]);
    else
      all.push_back(rows[i].latch);
  }
  return all;
}

/// What this node latched since `before`, on a sync of `source`.
std::optional<std::int64_t> new_latch(const std::optional<status::Latch>& before,
                                      const std::optional<status::Latch>& after, std::uint8_t source) {
  if (!after || after->count == (before ? before->count : 0) || after->source != source) return std::nullopt;
  return static_cast<std::int64_t>(after->clock_ns);
}

/// For each node in ring order, the name of its host: nodes of one host share a clock.
std::vector<std::string> clocks_of(const RingAccess& ring) {
  std::vector<std::string> clocks;
  for (const NodeName& node : ring.nodes()) clocks.push_back(node.host);
  return clocks;
}

/// Waits for the latches of nodes on other hosts, which come only with their next beacons.
Latches latches_after(const RingAccess& ring, const Latches& before, std::uint8_t source) {
  const auto deadline = std::chrono::steady_clock::now() + wire::kMissedBeacons * ring.beacon();
  for (;;) {
    const Latches after = last_latches(ring);
    bool all = true;
    for (std::size_t i = 0; i < after.size(); ++i)
      if (ring.is_elsewhere(ring.nodes()[i])) all = all && new_latch(before[i], after[i], source).has_value();
    if (all || std::chrono::steady_clock::now() >= deadline) return after;
    std::this_thread::sleep_for(kLatchesPollPeriod);
  }
}

Sync synchronize(const RingAccess& ring, const NodeName& from) {
  Sync sync;
  sync.source = index_of(ring, from.id);
  const Latches before = last_latches(ring);
  HostPort port = ring.connect(from);
  const json answer = ask(port, {{"do", "sync"}}, kInterruptTime);
  const Latches after = latches_after(ring, before, from.id);
  sync.outcome = answer.at("outcome").get<std::string>();
  sync.round_trip_us = answer.value("round_trip_us", 0.0);
  sync.ring_size = answer.value("ring_size", 0u);
  std::vector<std::optional<std::int64_t>> latches;
  for (std::size_t i = 0; i < after.size(); ++i) latches.push_back(new_latch(before[i], after[i], from.id));
  latches[sync.source] = answer.at("clock_ns").get<std::int64_t>();
  sync.offsets = clock_offsets(latches, sync.source, sync.round_trip_us, sync.ring_size);
  // The source latches before the interrupt leaves, which may have to wait.
  latches[sync.source] = answer.value("left_ns", *latches[sync.source]);
  sync.delays = line_delays(latches, clocks_of(ring), sync.source, sync.round_trip_us);
  return sync;
}

/// One-way time in us to `node` from the previous node that has latched; empty if it is not known.
std::optional<double> one_way_us(const Sync& sync, std::size_t node) {
  for (const LineDelay& line : sync.delays.lines)
    if (line.to == node) return line.us;
  return std::nullopt;
}

json row_json(const NodeName& node, const ClockOffset& offset, const std::optional<double>& one_way_us) {
  json row{{"id", node.id}, {"name", node.name}, {"latched", offset.offset_us.has_value()}};
  row["hops"] = offset.offset_us ? json(offset.hops) : json(nullptr);
  row["offset_us"] = offset.offset_us ? json(*offset.offset_us) : json(nullptr);
  row["one_way_us"] = one_way_us ? json(*one_way_us) : json(nullptr);
  return row;
}

void print_json(const RingAccess& ring, const Sync& sync) {
  json rows = json::array();
  for (std::size_t i = 0; i < sync.offsets.size(); ++i)
    rows.push_back(row_json(ring.nodes()[i], sync.offsets[i], one_way_us(sync, i)));
  const json all{{"ring", ring.ring()},
                 {"from", ring.nodes()[sync.source].id},
                 {"outcome", sync.outcome},
                 {"round_trip_us", sync.round_trip_us},
                 {"ring_size", sync.ring_size},
                 {"nodes", rows},
                 {"uncertain_us", sync.delays.uncertain_us},
                 {"between_hosts", {{"lines", sync.delays.between_hosts}, {"sum_us", sync.delays.between_hosts_us}}}};
  std::cout << all.dump(2) << '\n';
}

std::string between_hosts_words(const LineDelays& delays) {
  if (delays.between_hosts == 0) return {};
  return app::counted(delays.between_hosts, "line") + " between hosts, together " +
         app::number(delays.between_hosts_us) + " us: " + app::number(delays.between_hosts_us / delays.between_hosts) +
         " us each if they are alike; a single one-way time cannot be known without a shared clock\n";
}

std::string uncertain_words(const LineDelays& delays) {
  if (delays.uncertain_us == 0) return {};
  return "one way times are uncertain by " + app::number(delays.uncertain_us) +
         " us or more: a node may latch after it has passed the interrupt on\n";
}

void print_text(const RingAccess& ring, const Sync& sync) {
  std::vector<std::vector<std::string>> table{{"id", "name", "hops", "offset us", "one way us"}};
  for (std::size_t i = 0; i < sync.offsets.size(); ++i) {
    const auto& [hops, offset] = sync.offsets[i];
    const auto one_way = one_way_us(sync, i);
    table.push_back({std::to_string(ring.nodes()[i].id), ring.nodes()[i].name, offset ? std::to_string(hops) : "-",
                     offset ? app::number(*offset) : "-", one_way ? app::number(*one_way) : "-"});
  }
  std::cout << "sync " << sync.outcome << ", round trip " << app::number(sync.round_trip_us) << " us\n"
            << app::text_table(table) << between_hosts_words(sync.delays) << uncertain_words(sync.delays);
}

bool all_latched(const Sync& sync) {
  for (const auto& offset : sync.offsets)
    if (!offset.offset_us) return false;
  return sync.outcome == to_string(Outcome::delivered);
}

int run(const Context& context, const SyncOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  const Sync sync = synchronize(ring, ring.source(options.from));
  if (options.json)
    print_json(ring, sync);
  else
    print_text(ring, sync);
  return all_latched(sync) ? kDone : kNotDone;
}

void add_sync(CLI::App& app, Context& context) {
  auto options = std::make_shared<SyncOptions>();
  CLI::App* command = add_command(app, "sync", "Print how far the clocks of the nodes are off",
                                  "ringctl clock sync --from head", kSyncHelp);
  command->add_option("--from", options->from, "Node that sends; default: the first that answers");
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace

void add_clock(CLI::App& app, Context& context) {
  CLI::App& clock =
      add_group(app, "clock", "Pace, pause and step a virtual ring; compare clocks", "ringctl clock pause leg8");
  add_time(clock, context);
  add_sync(clock, context);
}

std::vector<ClockOffset> clock_offsets(const std::vector<std::optional<std::int64_t>>& latches_ns, std::size_t source,
                                       double round_trip_us, unsigned ring_size) {
  const double hop_us = ring_size > 0 ? round_trip_us / ring_size : 0.0;
  std::vector<ClockOffset> offsets(latches_ns.size());
  unsigned hops = 0;
  for (std::size_t step = 0; step < latches_ns.size(); ++step) {
    const std::size_t node = (source + step) % latches_ns.size();
    if (!latches_ns[node]) continue;  // bypassed, or its daemon is gone: no hop of its own
    const double apart_us = static_cast<double>(*latches_ns[node] - *latches_ns[source]) / 1000.0;
    offsets[node] = {hops, apart_us - hops * hop_us};
    ++hops;
  }
  return offsets;
}

}  // namespace limb_ring::ringctl
