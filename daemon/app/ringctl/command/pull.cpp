#include <CLI/CLI.hpp>
#include <memory>

#include "app/ringctl/choose_ring.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/results.h"
#include "app/ringctl/ring_access.h"
#include "cli/values.h"

namespace limb_ring::ringctl {

namespace {

struct PullOptions {
  std::string node;
  unsigned input = 0;
  bool json = false;
};

int run(const Context& context, const PullOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.node);
  HostPort port = ring.connect(ring.node(options.node));
  const auto pull = [&] { return port.pull(static_cast<std::uint8_t>(options.input)); };
  return report(send_all(port, 1, pull), options.json);
}

}  // namespace

void add_pull(CLI::App& app, Context& context) {
  auto options = std::make_shared<PullOptions>();
  CLI::App* command =
      add_command(app, "pull", "Pull an interrupt input of a node, as a button or watchdog wired to it would");
  command->add_option("NODE", options->node, "Node, id or name")->required();
  command->add_option("INPUT", options->input, "0 to 7; where it leads, the configuration says")
      ->required()
      ->transform(cli::whole(0, 7));
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
