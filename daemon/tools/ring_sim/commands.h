#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "study/analysis/medium.h"
#include "tools/common/rows.h"

namespace limb_ring::ring_sim {

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

/// Adds --seed, of everything random; 1 where it is not given.
void add_seed(CLI::App& command, std::uint64_t& seed);

// One subcommand each, in a file of its name.
void add_table(CLI::App& app, Context& context);
void add_run(CLI::App& app, Context& context);
void add_soak(CLI::App& app, Context& context);
void add_explore(CLI::App& app, Context& context);
void add_compare(CLI::App& app, Context& context);
void add_compare_traces(CLI::App& app, Context& context);
void add_plan(CLI::App& app, Context& context);

}  // namespace limb_ring::ring_sim
