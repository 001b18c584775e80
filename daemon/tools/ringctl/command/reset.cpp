#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "ring/reset_node.h"
#include "tools/cli/values.h"
#include "tools/ringctl/choose_ring.h"
#include "tools/ringctl/command/commands.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/progress.h"
#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

namespace {

struct ResetOptions {
  std::string node, from;
  double timeout_s = 3.0;
  bool json = false;
};

int code_of(const nlohmann::json& answer) {
  if (answer.value("success", false)) return kDone;
  return answer.value("effect", "") == "unknown" ? kUnknown : kNotDone;
}

int run(const Context& context, const ResetOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  ask::ResetQuery query;
  query.ring = ring.ring();
  query.nodes = ring.ask_nodes();
  query.target = ring.node(options.node).id;
  query.from = ring.source(options.from).id;
  query.from_is_free = options.from.empty();
  query.timeout = std::chrono::milliseconds(static_cast<int>(options.timeout_s * 1000));
  nlohmann::json answer;
  try {
    while_telling(query.ring, [&] { answer = ask::reset_node(query); });
  } catch (const HostPortTimeout&) {
    throw;
  } catch (const HostPortError& problem) {
    // A daemon that answers with an error is not a missing ring: kNotDone instead of kNoRing.
    if (ring.connect(ring.source(options.from)).connected()) throw NotDone(problem.what());
    throw;
  }
  if (options.json)
    std::cout << answer.dump(2) << '\n';
  else
    std::cout << answer.value("message", "") << '\n';
  return code_of(answer);
}

}  // namespace

void add_reset(CLI::App& app, Context& context) {
  auto options = std::make_shared<ResetOptions>();
  CLI::App* command = add_command(app, "reset", "Reset the CPU of a node by an interrupt", "ringctl reset left_knee",
                                  "Returns when the CPU has booted again.");
  command->add_option("NODE", options->node, "Node, id or name")->required();
  command->add_option("--from", options->from,
                      "Node that sends; default: the first that answers, in an open ring the one that reaches all");
  command->add_option("--timeout", options->timeout_s, "Seconds to wait, 0.1 to 600; default 3")
      ->transform(cli::seconds(0.1, 600.0));
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
