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
  std::string from, to;
  unsigned count = 10, size = 512, priority = 2;
  double interval_ms = 0, timeout_s = 10;
  bool json = false;
};

nlohmann::json request_of(const RingAccess& ring, const Options& options,
                          std::chrono::milliseconds deadline) {
  return {{"do", "ping"},
          {"to", ring.node(options.to).id},
          {"count", options.count},
          {"size", options.size},
          {"priority", options.priority},
          {"interval_us", static_cast<std::uint64_t>(options.interval_ms * 1000)},
          {"deadline_ms", deadline.count()}};
}

std::string microseconds(const nlohmann::json& answer, const char* which) {
  const auto pointer = nlohmann::json::json_pointer(std::string("/round_trip_us/") + which);
  if (!answer.contains(pointer) || !answer.at(pointer).is_number()) return "-";
  return app::number(answer.at(pointer).get<double>());
}

void print_text(const nlohmann::json& answer) {
  std::cout << "sent " << answer.value("sent", 0u) << ", delivered "
            << answer.value("delivered", 0u) << ", lost " << answer.value("lost", 0u);
  const nlohmann::json other = answer.value("other", nlohmann::json::object());
  for (const auto& [outcome, count] : other.items())
    std::cout << ", " << outcome << ' ' << count;
  std::cout << "\nround trip us: min " << microseconds(answer, "min") << ", p50 "
            << microseconds(answer, "p50") << ", p99 " << microseconds(answer, "p99") << ", max "
            << microseconds(answer, "max") << '\n';
}

int run(const Context& context, const Options& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  const std::chrono::milliseconds deadline(
      static_cast<std::int64_t>(options.timeout_s * 1000 + options.count * options.interval_ms));
  const nlohmann::json request = request_of(ring, options, deadline);
  HostPort port = ring.connect(ring.node(options.from));
  nlohmann::json answer = ask(port, request, deadline + kAnswerTime);
  answer["count"] = options.count;
  if (options.json) std::cout << answer.dump(2) << '\n';
  else print_text(answer);
  return answer.value("delivered", 0u) == options.count ? kDone : kNotDone;
}

void add_traffic_options(CLI::App& command, Options& options) {
  command.add_option("--count", options.count, "Packets, 1 to 1000000; default 10")
      ->check(CLI::Range(1, 1000000));
  command.add_option("--size", options.size, "Bytes in each, 1 to 512; default 512")
      ->check(CLI::Range(1, 512));
  command.add_option("--priority", options.priority, "0 (highest) to 3; default 2")
      ->check(CLI::Range(0, 3));
  command.add_option("--interval", options.interval_ms,
                     "Milliseconds between them, 0 to 10000; default 0: as one returns, the next")
      ->check(CLI::Range(0.0, 10000.0));
  command.add_option("--timeout", options.timeout_s,
                     "Seconds, beside the intervals, for all of it, 0.1 to 3600; default 10")
      ->check(CLI::Range(0.1, 3600.0));
}

}  // namespace

void add_ping(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      app, "ping", "Send packets made and timed in the daemon: first byte out to matched return");
  command->add_option("--from", options->from, "Node that sends, id or name")->required();
  command->add_option("--to", options->to, "Node to send to, id or name")->required();
  add_traffic_options(*command, *options);
  add_json(*command, options->json);
  command->callback([&context, options] {
    context.action = [&context, options] { return run(context, *options); };
  });
}

}  // namespace limb_ring::ringctl
