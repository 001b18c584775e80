#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace limb_ring::ringctl {

/// What the command line has said, shared by all subcommands.
struct Context {
  std::string ring;             ///< --ring; empty: the only one running
  std::function<int()> action;  ///< set by the subcommand given; @return an ExitCode
};

/// Adds a subcommand with the exit codes in its help. Its `--ring` is the global one.
CLI::App* add_command(CLI::App& app, const char* name, const char* description);
/// Adds the switch --json.
void add_json(CLI::App& command, bool& json);

}  // namespace limb_ring::ringctl
