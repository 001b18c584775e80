// Packet-hops per second of the real core under the virtual clock, with and without the invariants,
// beside a bare event loop and, where it is installed, ns-3.
#include <CLI/CLI.hpp>
#include <functional>
#include <iostream>

#include "bare_loop.h"
#include "core_ring.h"
#include "hops_report.h"
#include "load.h"
#include "ns3_program.h"
#include "tools/common/command_line.h"

namespace {

using namespace limb_ring::hops;
namespace app = limb_ring::app;
namespace cli = limb_ring::cli;

struct Options {
  std::uint64_t hops = 300'000;
  unsigned rounds = 9;
  bool json = false;
};

struct Contender {
  std::string name;
  std::function<double(unsigned nodes, std::uint64_t hops)> rate;
};

std::vector<Contender> contenders() {
  std::vector<Contender> all{
      {"bare loop", bare_loop},
      {"core", [](unsigned nodes, std::uint64_t hops) { return core_ring(nodes, hops, false); }},
      {"core, all invariants", [](unsigned nodes, std::uint64_t hops) { return core_ring(nodes, hops, true); }},
      {"ns-3", nullptr}};
  if (ns3_installed()) all.back().rate = ns3_ring;
  return all;
}

/// In turns, so that what disturbs the machine disturbs all alike.
std::vector<Series> measure(const Options& options) {
  const std::vector<Contender> all = contenders();
  std::vector<Series> series;
  for (const Contender& contender : all) series.push_back({contender.name, {}});
  for (unsigned round = 0; round < options.rounds; ++round)
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t size = 0; size < kSizes.size(); ++size)
        if (all[i].rate) series[i].rates[size].push_back(all[i].rate(kSizes[size], options.hops));
  return series;
}

void print_notes(const Options& options) {
  std::cout << "\nm_hops_s_N: with N nodes, millions of packet-hops per second of wall-clock time, best of "
            << options.rounds
            << " rounds;\n"
               "cost_N: of a hop, beside the bare loop's; growth: of a hop's cost from "
            << kSizes.front() << " to " << kSizes.back() << " nodes; medians\n"
            << "core: its nodes begin at random within a lap (seed " << kSeed << "), and are measured after "
            << kLapsBefore << " laps\n\n"
            << kBareLoop << '\n'
            << "ns-3: "
            << (ns3_installed() ? "devices that store and forward; per hop one copy, no CRC check; no IP stack\n"
                                : "not installed (libns3-dev)\n")
            << "goals: the core 0.8 times the bare loop, 6 with all invariants, growth of the core at most 1.1\n";
}

void print(const Options& options) {
  const std::vector<app::Row> rows = report(measure(options));
  std::cout << app::format_rows(rows, options.json ? app::Format::json : app::Format::text);
  if (!options.json) print_notes(options);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Rings of 16 and 254 nodes that always have 512 bytes to send, at 1 Gbit/s and d = 512 ns:\n"
      "the core under the virtual clock beside a bare event loop and ns-3.",
      "bench_sim_hops");
  app.add_option("--hops", options.hops, "Packet-hops per measurement, 1000 to 1000000000")
      ->transform(cli::whole(1000, 1'000'000'000))
      ->capture_default_str();
  app.add_option("--rounds", options.rounds, "All take turns so many times, 1 to 1000")
      ->transform(cli::whole(1, 1000))
      ->capture_default_str();
  app.add_flag("--json", options.json, "Print JSON, for programs");
  if (const auto end = cli::parse(app, argc, argv)) return *end;
  try {
    print(options);
  } catch (const std::exception& problem) {
    std::cerr << "bench_sim_hops: " << problem.what() << '\n';
    return 1;
  }
  return 0;
}
