#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/ringctl/answers.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "app/common/text_table.h"

namespace limb_ring::ringctl {

namespace {

struct Options {
  std::string node = "all", from;
  bool json = false;
};

int run(const Context& context, const Options& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  const bool all = options.node == "all";
  const nlohmann::json request{
      {"do", "stop"},
      {"node", all ? nlohmann::json("all") : nlohmann::json(ring.node(options.node).id)}};
  HostPort port = ring.connect(ring.source(options.from));
  const nlohmann::json answer = ask(port, request, std::chrono::seconds(10));
  const std::string outcome = answer.at("outcome").get<std::string>();
  if (options.json) std::cout << answer.dump(2) << '\n';
  else std::cout << "stop " << outcome << " in " << app::number(answer.value("round_trip_us", 0.0))
                 << " us\n";
  return outcome == to_string(Outcome::delivered) ? kDone : kNotDone;
}

}  // namespace

void add_stop(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      app, "stop", "Stop joints: an interrupt that sends CPUs into their safe state");
  command->add_option("NODE", options->node, "Node, id or name, or all (default)");
  command->add_option("--from", options->from, "Node that sends; default: the first that answers");
  add_json(*command, options->json);
  command->callback([&context, options] {
    context.action = [&context, options] { return run(context, *options); };
  });
}

}  // namespace limb_ring::ringctl
