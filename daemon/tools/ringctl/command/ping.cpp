#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <memory>

#include "tools/cli/values.h"
#include "tools/ringctl/choose_ring.h"
#include "tools/ringctl/command/commands.h"
#include "tools/ringctl/node_name.h"
#include "tools/ringctl/ping_report.h"
#include "tools/ringctl/ping_run.h"
#include "tools/ringctl/problems.h"

namespace limb_ring::ringctl {

namespace {

constexpr std::uint64_t kCountOfAReport = 10;  // of --json, which has to end
constexpr double kUnset = -1;

struct PingOptions {
  std::string from, to;
  std::uint64_t count = 0;
  unsigned size = kMaxPayload, priority = 2;
  double interval_s = kUnset, timeout_s = 0;
  bool flood = false, quiet = false, json = false;
};

std::chrono::nanoseconds to_nanoseconds(double seconds) {
  return std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

PingOrder order_of(const RingAccess& ring, const PingOptions& options) {
  PingOrder order;
  order.to = ring.node(options.to);
  order.count = options.count == 0 && options.json ? kCountOfAReport : options.count;
  const bool flood = options.flood || (options.json && options.interval_s == kUnset);
  order.interval = to_nanoseconds(flood ? 0 : options.interval_s == kUnset ? 1 : options.interval_s);
  if (options.timeout_s > 0) order.deadline = to_nanoseconds(options.timeout_s);
  order.size = options.size;
  order.priority = static_cast<std::uint8_t>(options.priority);
  return order;
}

int run(const Context& context, const PingOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  const PingOrder order = order_of(ring, options);
  const NodeName& from = ring.source(options.from);
  HostPort port = ring.connect(from, Stay::for_long);
  const bool lines = !options.quiet && !options.json;
  if (!options.json)
    std::cout << "PING " << label(order.to) << " from " << label(from) << ": " << order.size << " bytes of data"
              << std::endl;
  const PingTotals totals = PingRun(port, order, [&](std::uint64_t sequence, const Result& result) {
                              if (lines) std::cout << ping_line(order, sequence, result) << std::endl;
                            }).run();
  if (options.json)
    std::cout << ping_json(order, totals).dump(2) << '\n';
  else
    std::cout << (lines ? "\n" : "") << ping_text(order, totals);
  if (!totals.problem.empty()) throw HostPortError(totals.problem);
  const bool all = order.count == 0 || totals.sent == order.count;
  const std::uint64_t ended = totals.ended();
  return all && totals.with(Outcome::delivered) == ended && ended != 0 ? kDone : kNotDone;
}

void add_options(CLI::App& command, PingOptions& options) {
  command.add_option("TO,--to", options.to, "Node to send to, id or name; as `ping NODE` or `ping --to NODE`")
      ->required();
  command.add_option("--from", options.from, "Node that sends, id or name; default: the first that answers");
  command.add_option("-c,--count", options.count, "End after N packets, 1 to 1000000; default: at Ctrl-C (--json: 10)")
      ->transform(cli::whole(1, 1000000));
  CLI::Option* interval = command
                              .add_option("-i,--interval", options.interval_s,
                                          "Time between two, 0 to 3600 s, as 5ms or 0.2; default 1s, with --json 0")
                              ->transform(cli::seconds(0, 3600));
  command.add_flag("-f,--flood", options.flood, "No time between: as one returns, the next")->excludes(interval);
  command.add_flag("-q,--quiet", options.quiet, "Only the statistics at the end");
  command.add_option("-s,--size", options.size, "Bytes in each, 1 to 512; default 512")
      ->transform(cli::whole(1, kMaxPayload));
  command.add_option("--priority", options.priority, "0 (highest) to 3; default 2")->transform(cli::whole(0, 3));
  command.add_option("-w,--timeout", options.timeout_s, "End after that time, 0.001 to 3600 s; default: never")
      ->transform(cli::seconds(0.001, 3600));
}

}  // namespace

void add_ping(CLI::App& app, Context& context) {
  auto options = std::make_shared<PingOptions>();
  CLI::App* command =
      add_command(app, "ping", "Send packets to a node, and print each round trip", "ringctl ping left_knee --count 5",
                  "Goes on until Ctrl-C. The times are the daemon's, from the first byte that leaves to the matched "
                  "return.");
  add_options(*command, *options);
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
