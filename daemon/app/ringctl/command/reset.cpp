#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/ringctl/answers.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "cli/values.h"

namespace limb_ring::ringctl {

namespace {

struct Options {
  std::string node, from;
  double timeout_s = 3.0;
  bool json = false;
};

int run(const Context& context, const Options& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  const std::chrono::milliseconds timeout(static_cast<int>(options.timeout_s * 1000));
  const nlohmann::json request{{"do", "reset"},
                               {"node", ring.node(options.node).id},
                               {"timeout_ms", timeout.count()}};
  HostPort port = ring.connect(ring.source(options.from));
  const nlohmann::json answer = ask(port, request, timeout + kAnswerTime);
  if (options.json) std::cout << answer.dump(2) << '\n';
  else std::cout << answer.value("message", "") << '\n';
  return answer.value("success", false) ? kDone : kNotDone;
}

}  // namespace

void add_reset(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      app, "reset",
      "Reset the CPU of a node by an interrupt, and wait until it has booted again");
  command->add_option("NODE", options->node, "Node, id or name")->required();
  command->add_option("--from", options->from, "Node that sends; default: the first that answers");
  command->add_option("--timeout", options->timeout_s, "Seconds to wait, 0.1 to 600; default 3")
      ->transform(cli::seconds(0.1, 600.0));
  add_json(*command, options->json);
  command->callback([&context, options] {
    context.action = [&context, options] { return run(context, *options); };
  });
}

}  // namespace limb_ring::ringctl
