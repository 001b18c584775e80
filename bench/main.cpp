// ring_bench: rings of daemons, measured beside a bare reference ring in the same run.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>

#include "bench/suite.h"
#include "config/ring_config.h"
#include "io/program.h"
#include "io/signal_wait.h"
#include "io/spawn.h"
#include "tools/common/command_line.h"
#include "tools/common/text_table.h"

namespace limb_ring::bench {
namespace {

struct Options {
  Setup setup;
  bool json = false;
  bool no_ros = false;
};

/// humanoid16.yaml as installed, or as the devel space links to it; empty if it, or the program that is its CPU, is
/// not there.
std::string find_humanoid() {
  if (process::find_program("limb_firmware").empty()) return {};
  const std::string path = process::own_folder() + "/../../share/limb_ring/config/humanoid16.yaml";
  return std::filesystem::exists(path) ? path : std::string();
}

void run(Options& options) {
  process::SignalWait signals;
  options.setup.ros = !options.no_ros;
  options.setup.humanoid = find_humanoid();
  options.setup.tell = [](const std::string& what) { std::cerr << "ring_bench: " << what << std::endl; };
  options.setup.poll = [&signals] {
    if (process::SignalWait::asks_to_end(signals.next(std::chrono::milliseconds(0))))
      throw std::runtime_error("interrupted");
  };
  const live::PrivateFolder folder;
  const Report report = run_suite(options.setup, folder);
  if (options.json)
    std::cout << to_json(report).dump(2) << '\n';
  else
    std::cout << to_text(report);
  if (report.failed() != 0) throw std::runtime_error(app::counted(report.failed(), "packet") + " failed: see the rows");
}

void add_options(CLI::App& app, Options& options) {
  Setup& setup = options.setup;
  app.footer(cli::footer("Starts rings of its own, for about two minutes.", "ring_bench --nodes 8 --only shm,udp",
                         "Exit code: 0 done\n  1 packets failed, or it was interrupted\n  2 wrong arguments"));
  app.add_option("--nodes", setup.nodes, "Nodes in each ring, 2 to 64; default 16")->transform(cli::whole(2, 64));
  app.add_option("--payload", setup.payload, "Bytes of data in a packet, 4 to 512; default 512")
      ->transform(cli::whole(4, kMaxPayload));
  app.add_option("--seconds", setup.seconds, "Seconds per case, 0.1 to 60; default 2")
      ->transform(cli::seconds(0.1, 60.0));
  app.add_option("--rounds", setup.rounds, "How often reference and rings take turns, 1 to 100; default 3")
      ->transform(cli::whole(1, 100));
  app.add_option("--only", setup.only,
                 "Measure only these, beside the reference, separated by commas: " +
                     config::join({std::begin(kCases), std::end(kCases)}) +
                     ". With unix also the same ring while a dump reads along")
      ->delimiter(',')
      ->check(cli::one_of({std::begin(kCases), std::end(kCases)}));
  app.add_flag("--no-ros", options.no_ros, "Leave out the chain of topic_tools/relay");
  app.add_flag("--json", options.json, "Print JSON, for programs");
}

int run_command_line(int argc, char** argv) {
  Options options;
  CLI::App app("Measures rings beside a bare reference ring.", "ring_bench");
  add_options(app, options);
  if (const auto end = cli::parse(app, argc, argv)) return *end;
  try {
    run(options);
    return 0;
  } catch (const config::ConfigError& problem) {
    std::cerr << "ring_bench: " << problem.what() << '\n';
    return 2;
  } catch (const std::exception& problem) {
    std::cerr << "ring_bench: " << problem.what() << '\n';
    return 1;
  }
}

}  // namespace
}  // namespace limb_ring::bench

int main(int argc, char** argv) {
  limb_ring::process::open_standard_descriptors();
  limb_ring::process::outlive_file_limit();
  return limb_ring::cli::code_with_output("ring_bench", limb_ring::bench::run_command_line(argc, argv));
}
