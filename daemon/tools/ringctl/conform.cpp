#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstring>

#include "io/program.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
namespace {

/// The kit, which lies in a folder beside ringctl, takes this process over. Its exit codes become ours.
/// @throw NotDone if it cannot be started
int run_kit(const Context& context) {
  const std::string kit = process::own_folder() + "/conform/conform";
  std::vector<std::string> words{kit};
  const auto own = std::find(context.arguments.begin(), context.arguments.end(), "conform");
  if (own != context.arguments.end()) words.insert(words.end(), own + 1, context.arguments.end());
  const int error = process::execute(kit, words);
  throw NotDone(kit + ": " + std::strerror(error));
}

}  // namespace

void add_conform(CLI::App& app, Context& context) {
  CLI::App* command =
      add_command(app, "conform", "Test a node of another make against docs/protocol.md", "ringctl conform --list",
                  "Plays all neighbours of that node, and gives a verdict for each rule. All arguments go to the kit: "
                  "'ringctl conform --usage' prints its options, --list its cases.");
  command->fallthrough(false);
  command->prefix_command();
  command->callback([&context] { context.action = [&context] { return run_kit(context); }; });
}

}  // namespace limb_ring::ringctl
