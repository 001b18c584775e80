#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/ringctl/answers.h"
#include "app/ringctl/choose_ring.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/results.h"
#include "ask/known_stops.h"

namespace limb_ring::ringctl {

namespace {

struct StopOptions {
  std::string node = "all", from;
  bool json = false;
};

nlohmann::json to_json(const std::vector<ask::KnownStop>& stops) {
  nlohmann::json list = nlohmann::json::array();
  for (const ask::KnownStop& stop : stops)
    list.push_back({{"id", stop.node.id}, {"name", stop.node.name}, {"stop", to_string(stop.state)}});
  return list;
}

std::string text_of(const nlohmann::json& answer, const std::vector<ask::KnownStop>& stops) {
  const std::string ended = ended_text(answer.at("outcome").get<std::string>(), answer.value("round_trip_us", 0.0),
                                       answer.value("tries", 0u), answer.value("reason", ""));
  return "the stop " + ended + '\n' + sentence_of(stops) + '\n';
}

// `delivered` says no more than that it went round: a node in another part of the ring, frozen or bypassed was not
// reached.
int code_of(const std::string& outcome, const std::vector<ask::KnownStop>& stops) {
  if (all_told(stops)) return kDone;
  const bool may_be = outcome == to_string(Outcome::delivered) || outcome == to_string(Outcome::unconfirmed) ||
                      outcome == to_string(Outcome::lost);
  return may_be ? kUnknown : kNotDone;
}

// The stop goes first; what is known of it is asked for afterwards.
int run(const Context& context, const StopOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  const bool all = options.node == "all";
  std::vector<ask::Node> nodes = ring.ask_nodes();
  if (!all) nodes = {{ring.node(options.node).id, ring.node(options.node).name}};
  const nlohmann::json request{{"do", "stop"}, {"node", all ? nlohmann::json("all") : nlohmann::json(nodes[0].id)}};
  HostPort port = ring.connect(ring.source(options.from));
  const auto sent = std::chrono::steady_clock::now();
  nlohmann::json answer = ask(port, request, kInterruptTime);
  const bool delivered = answer.at("outcome") == to_string(Outcome::delivered);
  const auto stops = ask::wait_for_stops(ring.ring(), nodes, sent, delivered);
  answer["nodes"] = to_json(stops);
  if (options.json)
    std::cout << answer.dump(2) << '\n';
  else
    std::cout << text_of(answer, stops);
  return code_of(answer.at("outcome").get<std::string>(), stops);
}

}  // namespace

void add_stop(CLI::App& app, Context& context) {
  auto options = std::make_shared<StopOptions>();
  CLI::App* command = add_command(
      app, "stop", "Stop joints: an interrupt that sends CPUs into their safe state, until 'ringctl resume'");
  command->add_option("NODE", options->node, "Node, id or name, or all (default)");
  command->add_option("--from", options->from, "Node that sends; default: the first that answers");
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
