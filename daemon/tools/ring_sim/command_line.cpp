#include "tools/ring_sim/command_line.h"

#include <algorithm>
#include <iostream>
#include <limits>

#include "config/quantity.h"
#include "sim/invariants.h"
#include "tools/common/command_line.h"
#include "tools/common/text_table.h"
#include "wire/packet.h"
#include "wire/pcapng.h"

namespace limb_ring::ring_sim {

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      const std::string& example, const std::string& more) {
  CLI::App* command = app.add_subcommand(name, description);
  command->footer(cli::footer(more, example, kExitCodesInShort));
  return command;
}

void add_format(CLI::App& command, app::Format& format) {
  auto* json = command.add_flag_callback(
      "--json", [&format] { format = app::Format::json; }, "Print JSON, for programs");
  auto* csv = command.add_flag_callback(
      "--csv", [&format] { format = app::Format::csv; }, "Print CSV, for programs");
  json->excludes(csv);
}

namespace {

constexpr std::uint64_t kMostRate = 100'000'000'000;

std::string read_rate(const std::string& text, study::Medium& medium) {
  const auto rate = config::parse_rate(text);
  if (!rate || *rate < 1000 || *rate > kMostRate)
    return "'" + text + "' is not a rate: 1kbit/s to 100Gbit/s, as 1Gbit/s, 16Mbit/s or a number of bit/s";
  medium.rate = *rate;
  return {};
}

std::string read_delay(const std::string& text, study::Medium& medium) {
  const auto delay = config::parse_time(text);
  if (!delay || delay->count() < 0 || *delay > std::chrono::seconds(1))
    return "'" + text + "' is not a time of 0s to 1s, with its unit: 512ns, 1us";
  medium.relay_delay = *delay;
  return {};
}

}  // namespace

void add_medium(CLI::App& command, study::Medium& medium) {
  command.add_option("--nodes", medium.nodes, "Nodes, 2 to 254; default 16")->transform(cli::whole(2, 254));
  command.add_option("--payload", medium.payload, "Bytes of data in a packet, 1 to 512; default 512")
      ->transform(cli::whole(1, wire::kMaxPayload));
  add_lines(command, medium);
}

void add_lines(CLI::App& command, study::Medium& medium) {
  const auto add = [&command, &medium](const char* name, const char* type, const char* text, auto read) {
    command
        .add_option_function<std::string>(
            name, [](const std::string&) {}, text)
        ->check(CLI::Validator([&medium, read](const std::string& value) { return read(value, medium); }, type));
  };
  add("--rate", "RATE", "Data rate R of every line, bit/s or with a unit; default 1Gbit/s", read_rate);
  add("--relay-delay", "TIME", "Relay delay d of every node, with a unit; default 512ns", read_delay);
}

void add_folding(CLI::App& command, study::FoldingRings& folding, const std::string& help) {
  command
      .add_option_function<std::string>(
          "--redundancy",
          [&folding](const std::string& what) {
            folding = what == "foldback" ? study::FoldingRings::all : study::FoldingRings::some;
          },
          help)
      ->transform(cli::one_of({"mixed", "foldback"}));
}

void add_world(CLI::App& command, study::WorldKind& world, study::RandomFaults::More& more) {
  const auto& names = study::kWorldNames;
  command
      .add_option_function<std::string>(
          "--world",
          [&world, &names](const std::string& what) {
            world = static_cast<study::WorldKind>(std::find(names.begin(), names.end(), what) - names.begin());
          },
          "usual (default); wide: sparse ids, now and then up to 254 nodes, lines of different kinds, nodes and "
          "lines that stand still; parts: like wide with up to 16 nodes, hosts that lose each other and regroup, "
          "line ends that notice late, several faults within one lap; storms: 3 to 6 nodes that fold back, cut and "
          "mended again and again before such a series of faults")
      ->transform(cli::one_of({names.begin(), names.end()}));
  command
      .add_option("--drift", more.drift,
                  "Each node's clock is up to N millionths too fast or too slow, 0 to 100000; default 0")
      ->transform(cli::whole(0, 100'000));
  command.add_flag("--clocks", more.clocks,
                   "Now and then a node's wall clock is set by up to an hour, or a host is suspended: all its nodes "
                   "stand still, and their monotonic clocks too");
}

static_assert(static_cast<int>(sim::NeedsWorld::usual) == static_cast<int>(study::WorldKind::usual) &&
              static_cast<int>(sim::NeedsWorld::wide) == static_cast<int>(study::WorldKind::wide) &&
              static_cast<int>(sim::NeedsWorld::parts) == static_cast<int>(study::WorldKind::parts));

study::WorldKind world_for(const sim::Goal* sought, study::WorldKind world) {
  return sought == nullptr ? world : std::max(world, static_cast<study::WorldKind>(sought->world));
}

std::string options_of(const study::RandomFaults::Origin& origin) {
  const auto& more = origin.more;
  std::string text = origin.fold_back == study::FoldingRings::all ? " --redundancy foldback" : "";
  if (origin.world != study::WorldKind::usual)
    text += std::string(" --world ") + study::kWorldNames[static_cast<std::size_t>(origin.world)];
  if (more.drift != 0) text += " --drift " + std::to_string(more.drift);
  if (more.sought != nullptr) text += std::string(" --seek ") + more.sought->name;
  return text + (more.clocks ? " --clocks" : "");
}

std::size_t read_goal(const std::string& name) {
  if (const auto goal = sim::goal_named(name)) return *goal;
  throw CLI::ValidationError("--seek", "'" + name + "' is not a goal; 'ring_sim soak --goals' lists them");
}

void add_seed(CLI::App& command, std::uint64_t& seed) {
  command.add_option("--seed", seed, "Seed of everything random, from 0; default 1")
      ->transform(cli::whole(0, std::numeric_limits<std::int64_t>::max()));
}

namespace {

int failed(const std::exception& problem, ExitCode code) {
  std::cerr << "ring_sim: " << problem.what() << '\n';
  return code;
}

/// The command line that repeats a run: the seed is said where it was not given.
std::string again(int argc, char** argv) {
  std::string text = "again with: ring_sim";
  bool seed = false;
  for (int i = 1; i < argc; ++i) {
    text += ' ' + app::shell_word(argv[i]);
    seed = seed || std::string(argv[i]).rfind("--seed", 0) == 0;
  }
  return text + (seed ? "" : " --seed 1");
}

int act(const Context& context, int argc, char** argv) {
  try {
    return context.action();
  } catch (const sim::BrokenPromise& broken) {
    std::cerr << "ring_sim: " << broken.what() << '\n' << again(argc, argv) << '\n';
    return kBroken;
  } catch (const UsageError& problem) {
    return failed(problem, kUsage);
  } catch (const config::ConfigError& problem) {
    return failed(problem, kUsage);
  } catch (const capture::CaptureFileError& problem) {
    return failed(problem, kUsage);
  } catch (const std::exception& problem) {
    return failed(problem, kBroken);
  }
}

}  // namespace

int run_command_line(int argc, char** argv) {
  Context context;
  CLI::App app("Simulates a ring under a virtual clock, with the core that ringd runs.", "ring_sim");
  app.footer(cli::footer("", "ring_sim plan leg8 --simulate", kExitCodesHelp));
  app.require_subcommand(1);
  add_run(app, context);
  add_plan(app, context);
  for (const auto add : {add_table, add_compare_traces, add_soak, add_cause, add_explore}) add(app, context);
  for (const char* name : {"table", "compare-traces", "soak", "cause", "explore"})
    app.get_subcommand(name)->group("For those who change limb_ring");
  if (const auto end = cli::parse(app, argc, argv)) return *end;
  return act(context, argc, argv);
}

}  // namespace limb_ring::ring_sim
