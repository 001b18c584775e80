#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "sim/goals.h"
#include "study/model_ring.h"
#include "study/random_faults.h"
#include "tools/common/text_table.h"

namespace limb_ring::ring_sim {

/// Runs ring_sim. Errors go to standard error. @return an ExitCode
int run_command_line(int argc, char** argv);

/// What the command line has said.
struct Context {
  std::function<int()> action;  ///< set by the subcommand given; @return an ExitCode
};

/// Adds a subcommand.
/// @param description what the list of commands says of it: one line
/// @param example a whole command line
/// @param more what else its own --help says
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      const std::string& example, const std::string& more = {});

/// Adds --json and --csv.
void add_format(CLI::App& command, app::Format& format);

/// Adds --nodes, --payload, --rate and --relay-delay, each checked.
void add_medium(CLI::App& command, study::Medium& medium);
/// Adds --rate and --relay-delay alone.
void add_lines(CLI::App& command, study::Medium& medium);

/// Adds --redundancy, of rings that are drawn by seed: mixed or foldback. @param help of that option
void add_folding(CLI::App& command, study::FoldingRings& folding, const std::string& help);
/// Adds --world, --drift and --clocks, of those rings.
void add_world(CLI::App& command, study::WorldKind& world, study::RandomFaults::More& more);
/// The world that is asked for, or the least that can meet what is sought.
study::WorldKind world_for(const sim::Goal* sought, study::WorldKind world);
/// The options that give that run again, beside its seed, each behind a space; none for what is usual.
std::string options_of(const study::RandomFaults::Origin& origin);
/// A goal by its name. @throw CLI::ValidationError
std::size_t read_goal(const std::string& name);

/// Adds --seed, of everything random; 1 if it is not given.
void add_seed(CLI::App& command, std::uint64_t& seed);

// One subcommand each, in a file of its name.
void add_table(CLI::App& app, Context& context);
void add_run(CLI::App& app, Context& context);
void add_soak(CLI::App& app, Context& context);
void add_cause(CLI::App& app, Context& context);
void add_explore(CLI::App& app, Context& context);
void add_compare_traces(CLI::App& app, Context& context);
void add_plan(CLI::App& app, Context& context);

/// What ring_sim ends with; every --help says so too.
enum ExitCode : int {
  kDone = 0,
  /// A promise of the ring was broken, a plan does not fit onto it, two captures differ, a disk is full,
  /// or somebody has asked it to end before all was done.
  kBroken = 1,
  /// Wrong arguments, a configuration that is refused, or a folder that cannot be written.
  kUsage = 2
};

/// Of the help of a subcommand.
constexpr const char* kExitCodesInShort = "Exit code: 0 done, 1 broken promise or failure, 2 wrong arguments.";

constexpr const char* kExitCodesHelp =
    "Exit code: 0 done\n"
    "  1 a promise of the ring was broken, a plan does not fit onto it, two captures differ, a disk is full, or it was "
    "interrupted\n"
    "  2 wrong arguments or configuration, or a folder that cannot be written";

/// Ends ring_sim with kUsage.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Says on standard error what is being done, every two seconds, once it takes longer than that.
class Progress {
 public:
  explicit Progress(const char* program = "ring_sim") : program_(program) {}
  void tell(const std::string& what) {
    const auto now = Clock::now();
    if (now < next_) return;
    next_ = now + kQuiet;
    std::cerr << program_ << ": " << what << " ..." << std::endl;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kQuiet{2};
  const char* program_;
  Clock::time_point next_ = Clock::now() + kQuiet;
};

/// A rate in Mbit/s as short as it can be said: 0.001, 2.5, 1000. @param rate bit/s
inline std::string megabits(std::uint64_t rate) {
  std::ostringstream text;
  text << static_cast<double>(rate) / 1e6;
  return text.str();
}

}  // namespace limb_ring::ring_sim
