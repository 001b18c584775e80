#include <CLI/CLI.hpp>
#include <memory>

#include "app/ringctl/choose_ring.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/results.h"
#include "app/ringctl/ring_access.h"
#include "cli/values.h"

namespace limb_ring::ringctl {

namespace {

struct InterruptOptions {
  std::string from, to;
  unsigned factor = 0;
  bool force = false, json = false;
};

int run(const Context& context, const InterruptOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  const std::uint8_t to = ring.destination(options.to);
  HostPort port = ring.connect(ring.node(options.from));
  const auto send = [&] { return port.interrupt(to, static_cast<std::uint8_t>(options.factor), options.force); };
  return report(send_and_explain(port, ring, to, 1, send), options.json);
}

}  // namespace

void add_interrupt(CLI::App& app, Context& context) {
  auto options = std::make_shared<InterruptOptions>();
  CLI::App* command =
      add_command(app, "interrupt", "Send an interrupt packet: pulls the pin of that number at its destination");
  command->add_option("--from", options->from, "Node that sends, id or name")->required();
  command->add_option("--to", options->to, "Node to interrupt, id or name, or all")->required();
  command
      ->add_option("FACTOR", options->factor, "0 to 7; unless configured otherwise 0 resets, 1 stops, 2 latches clocks")
      ->required()
      ->transform(cli::whole(0, 7));
  command->add_flag("--force", options->force, "Also where it would reset the CPUs of all nodes");
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
