#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "bench/suite.h"
#include "config/ring_config.h"
#include "io/program.h"
#include "io/signal_wait.h"
#include "tools/common/command_line.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
namespace {

struct BenchOptions {
  bench::Setup setup;
  bool json = false;
  bool no_ros = false;
};

/// humanoid16.yaml as installed, or as the devel space links to it; empty where it, or the program that is its CPU, is
/// not there.
std::string find_humanoid() {
  if (process::find_program("limb_firmware").empty()) return {};
  const std::string path = process::own_folder() + "/../../share/limb_ring/config/humanoid16.yaml";
  return std::filesystem::exists(path) ? path : std::string();
}

int run(BenchOptions& options) {
  process::SignalWait signals;
  options.setup.ros = !options.no_ros;
  options.setup.humanoid = find_humanoid();
  options.setup.tell = [](const std::string& what) { std::cerr << "bench: " << what << std::endl; };
  options.setup.poll = [&signals] {
    if (process::SignalWait::asks_to_end(signals.next(std::chrono::milliseconds(0)))) throw NotDone("interrupted");
  };
  const live::PrivateFolder folder;
  const bench::Report report = bench::run_suite(options.setup, folder);
  if (options.json)
    std::cout << bench::to_json(report).dump(2) << '\n';
  else
    std::cout << bench::to_text(report);
  if (report.failed() != 0) throw NotDone(app::counted(report.failed(), "packet") + " failed: see the rows");
  return kDone;
}

}  // namespace

void add_bench(CLI::App& app, Context& context) {
  auto options = std::make_shared<BenchOptions>();
  bench::Setup& setup = options->setup;
  CLI::App* command =
      add_command(app, "bench", "Measure rings beside a bare reference ring", "ringctl bench --nodes 8 --only shm,udp",
                  "Starts rings of its own, for about two minutes. Ends with 1 if packets failed.");
  command->add_option("--nodes", setup.nodes, "Nodes in each ring, 2 to 64; default 16")->transform(cli::whole(2, 64));
  command->add_option("--payload", setup.payload, "Bytes of data in a packet, 4 to 512; default 512")
      ->transform(cli::whole(4, kMaxPayload));
  command->add_option("--seconds", setup.seconds, "Seconds per case, 0.1 to 60; default 2")
      ->transform(cli::seconds(0.1, 60.0));
  command->add_option("--rounds", setup.rounds, "How often reference and rings take turns, 1 to 100; default 3")
      ->transform(cli::whole(1, 100));
  command
      ->add_option("--only", setup.only,
                   "Measure only these, beside the reference, separated by commas: " +
                       config::join({std::begin(bench::kCases), std::end(bench::kCases)}) +
                       ". With unix also the same ring while a dump reads along")
      ->delimiter(',')
      ->check(cli::one_of({std::begin(bench::kCases), std::end(bench::kCases)}));
  command->add_flag("--no-ros", options->no_ros, "Leave out the chain of topic_tools/relay");
  add_json(*command, options->json);
  command->callback([&context, options] {
    context.action = [&context, options] {
      require_no_ring(context, "the benchmark has rings of its own");
      return run(*options);
    };
  });
}

}  // namespace limb_ring::ringctl
