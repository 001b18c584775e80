#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>

#include "config/names.h"
#include "ring/send_on.h"
#include "tools/ringctl/answers.h"
#include "tools/ringctl/choose_ring.h"
#include "tools/ringctl/command/commands.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/results.h"

namespace limb_ring::ringctl {

namespace {

struct StopOptions {
  std::string node = "all", from;
  bool json = false;
};

constexpr const char* kStopHelp =
    "An interrupt sends CPUs into their safe state. Without --from, nodes that the stop has not reached are asked to "
    "send it as well, so it reaches all nodes of this host also in an open chain, or in a ring that has folded into "
    "parts.\n"
    "Ends with 0 if each CPU has said that it stopped, or was told while it ran and is of a kind that never says so "
    "(not limb_firmware). Ends with 1 if the stop did not reach a node. Ends with 4 if nobody knows: the daemon of a "
    "node does not answer, or its CPU was told and is silent, or did not run and comes up without the stop.";

nlohmann::json to_json(const std::vector<ask::KnownStop>& stops) {
  nlohmann::json list = nlohmann::json::array();
  for (const ask::KnownStop& stop : stops)
    list.push_back({{"id", stop.node.id}, {"name", stop.node.name}, {"stop", to_string(stop.state)}});
  return list;
}

std::string text_of(const nlohmann::json& answer, const std::vector<ask::KnownStop>& stops) {
  const std::string ended = ended_text(answer.at("outcome").get<std::string>(), answer.value("round_trip_us", 0.0),
                                       answer.value("tries", 0u), answer.value("reason", ""));
  const auto senders = answer.at("sent_from").get<std::vector<std::string>>();
  const std::string from = senders.size() > 1 ? "; sent from " + config::join(senders, ", then ") : "";
  return "the stop " + ended + from + '\n' + sentence_of(stops) + '\n';
}

// `delivered` says no more than that it went round: a node in another part of the ring, frozen or bypassed was not
// reached.
int code_of(const std::string& outcome, const std::vector<ask::KnownStop>& stops) {
  if (all_told(stops)) return kDone;
  if (any_is(stops, ask::StopState::not_reached)) return kNotDone;
  const bool may_be = outcome == to_string(Outcome::delivered) || outcome == to_string(Outcome::unconfirmed) ||
                      outcome == to_string(Outcome::lost);
  return may_be || !any_is(stops, ask::StopState::unknown) ? kUnknown : kNotDone;
}

/// A stop of one node or of all, from one node or from as many as it takes to reach them.
class Stop {
 public:
  Stop(const RingAccess& ring, const StopOptions& options) : ring_(ring) {
    stop_.ring = ring.ring();
    stop_.nodes = ring.ask_nodes();
    stop_.of_all = options.node == "all";
    if (!stop_.of_all) stop_.nodes = {{ring.node(options.node).id, ring.node(options.node).name}};
    stop_.sent = std::chrono::steady_clock::now();
  }

  void send_from(const NodeName& node) { stop_.delivered = sent_from(node, kInterruptTime); }

  void send_on(const NodeName& from) {
    const auto deadline = std::chrono::steady_clock::now() + kInterruptTime;
    ask::send_on(stop_, from.id, deadline, [this](std::uint8_t node, std::chrono::milliseconds timeout) {
      return sent_from(ring_.node(std::to_string(node)), timeout);
    });
  }

  /// What the daemon has said, and what is known of each node.
  nlohmann::json& answer() { return answer_; }
  std::vector<ask::KnownStop> wait() const { return ask::wait_for_stops(stop_); }

 private:
  /// @return it was delivered
  bool sent_from(const NodeName& node, std::chrono::milliseconds timeout) {
    HostPort port = ring_.connect(node);
    const nlohmann::json to = stop_.of_all ? nlohmann::json("all") : nlohmann::json(stop_.nodes[0].id);
    const nlohmann::json answer = ask(port, {{"do", "stop"}, {"node", to}}, timeout);
    const nlohmann::json senders = answer_.is_null() ? nlohmann::json::array() : answer_["sent_from"];
    if (answer_.is_null() || !stop_.of_all) answer_ = answer;
    answer_["sent_from"] = senders;
    answer_["sent_from"].push_back(node.name);
    return answer.at("outcome") == to_string(Outcome::delivered);
  }

  const RingAccess& ring_;
  ask::SentStop stop_;
  nlohmann::json answer_;
};

// The stop goes first; what is known of it is asked for afterwards.
int run(const Context& context, const StopOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  Stop stop(ring, options);
  const NodeName from = ring.source(options.from);
  stop.send_from(from);
  if (options.from.empty()) stop.send_on(from);
  const auto stops = stop.wait();
  nlohmann::json& answer = stop.answer();
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
  CLI::App* command = add_command(app, "stop", "Stop joints, until 'ringctl resume'", "ringctl stop", kStopHelp);
  command->add_option("NODE", options->node, "Node, id or name, or all (default)");
  command->add_option("--from", options->from,
                      "Only this node sends; default: the first that answers, and others if one does not reach all");
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
