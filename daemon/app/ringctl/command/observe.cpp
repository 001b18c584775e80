#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/common/out_file.h"
#include "app/ringctl/choose_ring.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/connect_node.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/ring_access.h"
#include "app/ringctl/tell_user.h"
#include "cli/values.h"
#include "client/event_kinds.h"
#include "config/names.h"
#include "process/signal_wait.h"

namespace limb_ring::ringctl {

namespace {

struct ObserveOptions {
  std::string node;
  std::vector<std::string> kinds;
  std::uint64_t count = 0;
};

void print_lost(const ObservedLost& lost) { tell_user("read too slowly, " + std::to_string(lost.count) + " left out"); }

/// Lines until `count` are out (0: without end), Ctrl-C, nobody reads them, or the daemon is gone.
int print_lines(HostPort& port, std::uint64_t count) {
  const process::SignalWait signals;
  for (std::uint64_t lines = 0; app::is_output_read() && (count == 0 || lines < count);) {
    const auto message = port.receive(process::SignalWait::kTick);
    if (process::SignalWait::asks_to_end(signals.next(std::chrono::milliseconds(0)))) return kDone;
    if (!message) continue;
    if (const auto* seen = std::get_if<Observed>(&*message)) {
      const auto event = nlohmann::json::parse(seen->json, nullptr, /*allow_exceptions=*/false);
      if (event.is_object() && event.contains("error")) throw UsageError(event["error"].get<std::string>());
      std::cout << seen->json << std::endl;
      ++lines;
    } else if (const auto* lost = std::get_if<ObservedLost>(&*message)) {
      print_lost(*lost);
    } else if (const auto* end = std::get_if<Disconnected>(&*message)) {
      throw gone(port, end->reason);
    }
  }
  return kDone;
}

int run(const Context& context, const ObserveOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.node);
  HostPort port = ring.connect(ring.node(options.node), Stay::for_long);
  nlohmann::json filter = nlohmann::json::object();
  if (!options.kinds.empty()) filter["kinds"] = options.kinds;
  port.observe(filter.dump());
  return print_lines(port, options.count);
}

}  // namespace

void add_observe(CLI::App& app, Context& context) {
  auto options = std::make_shared<ObserveOptions>();
  CLI::App* command = add_command(
      app, "observe", "Print the events of a node, a line of JSON each, until interrupted; packets: 'ringctl dump'");
  command->add_option("NODE", options->node, "Node, id or name")->required();
  command
      ->add_option("--kinds", options->kinds, "Only these kinds of events, of: " + config::join(client::event_kinds()))
      ->delimiter(',')
      ->transform(cli::one_of(client::event_kinds()));
  command->add_option("-n,--count", options->count, "End after so many lines; default 0: never")
      ->transform(cli::whole(0, 1000000000));
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
