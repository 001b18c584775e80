#include <CLI/CLI.hpp>
#include <memory>

#include "tools/common/command_line.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/send.h"

namespace limb_ring::ringctl {
namespace {

struct InterruptOptions {
  std::string from, to;
  std::optional<unsigned> factor, input;
  bool force = false, json = false;
};

Sends send_packet(const RingAccess& ring, HostPort& port, const InterruptOptions& options) {
  const std::uint8_t to = ring.destination(options.to);
  const auto send = [&] { return port.interrupt(to, static_cast<std::uint8_t>(*options.factor), options.force); };
  return send_and_explain(port, ring, to, 1, send);
}

Sends pull_input(HostPort& port, unsigned input) {
  return send_all(port, 1, [&] { return port.pull(static_cast<std::uint8_t>(input)); });
}

int run(const Context& context, const InterruptOptions& options) {
  if (options.factor.has_value() == options.input.has_value())
    throw UsageError("interrupt: either FACTOR, with --to NODE, or --input N, of the node --from");
  if (options.factor && options.to.empty()) throw UsageError("interrupt: --to is required: NODE, or all");
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  HostPort port = ring.connect(ring.node(options.from));
  return report(options.input ? pull_input(port, *options.input) : send_packet(ring, port, options), options.json);
}

}  // namespace

void add_interrupt(CLI::App& app, Context& context) {
  auto options = std::make_shared<InterruptOptions>();
  CLI::App* command =
      add_command(app, "interrupt", "Send an interrupt packet, or pull an input of a node",
                  "ringctl interrupt --from head --to left_knee 0",
                  "The packet pulls the pin with the number FACTOR at its destination. --input does what a button "
                  "or a watchdog does that is wired to the node --from.");
  command->add_option("--from", options->from, "Node that sends, or whose input it is, id or name")->required();
  CLI::Option* to = command->add_option("--to", options->to, "Node to interrupt, id or name, or all");
  command
      ->add_option("FACTOR", options->factor, "0 to 7; unless configured otherwise 0 resets, 1 stops, 2 latches clocks")
      ->transform(cli::whole(0, 7));
  CLI::Option* force =
      command->add_flag("--force", options->force, "Send a broadcast that would reset the CPUs of all nodes");
  command->add_option("--input", options->input, "Pull this input instead, 0 to 7; the ring's file says where it leads")
      ->transform(cli::whole(0, 7))
      ->excludes(to)
      ->excludes(force);
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
