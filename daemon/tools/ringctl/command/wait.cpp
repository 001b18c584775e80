#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "config/names.h"
#include "tools/cli/values.h"
#include "tools/ringctl/command/commands.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/ring_wait.h"

namespace limb_ring::ringctl {

namespace {

struct WaitOptions {
  std::string what, state;
  double timeout_s = 10;
};

Lack lack_of(const WaitOptions& options) {
  if (!options.state.empty())
    return [options](const auto& rows) { return lack_of_state(rows, options.what, options.state); };
  if (options.what != "up")
    throw UsageError(
        "'ringctl wait up' waits for the whole ring, 'ringctl wait NODE STATE' for one node: for which "
        "state of " +
        options.what + "? " + config::join(state_words()));
  return lack_of_whole;
}

int run(const Context& context, const WaitOptions& options) {
  const std::chrono::milliseconds timeout(std::llround(options.timeout_s * 1000));
  const std::string lacking = wait_for(context.ring, timeout, lack_of(options));
  if (!lacking.empty()) throw NotDone(lacking);
  return kDone;
}

}  // namespace

void add_wait(CLI::App& app, Context& context) {
  auto options = std::make_shared<WaitOptions>();
  CLI::App* command = add_command(app, "wait", "Return when the ring is whole, or a node is in a state",
                                  "ringctl wait left_knee running --timeout 5s");
  command
      ->add_option("WHAT", options->what,
                   "up: all nodes are, and the CPUs that ringd starts run; or a node, id or name")
      ->required();
  command
      ->add_option("STATE", options->state,
                   "Of that node or its CPU, in the words of 'ringctl status': up, down, "
                   "open_chain ...; running, hung, stopped, failed ...")
      ->transform(cli::one_of(state_words()));
  command->add_option("--timeout", options->timeout_s, "Exit code 1 after that time, 0 to 3600 s; default 10s")
      ->transform(cli::seconds(0, 3600));
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
