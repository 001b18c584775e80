#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <set>

#include "config/ring_config.h"
#include "ring/known_stops.h"
#include "ring/reset_node.h"
#include "ring/ring_client.h"
#include "tools/common/command_line.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/send.h"

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
    "Exits with 0 if each CPU has confirmed that it stopped. For a CPU that never confirms (limb_firmware does) it is "
    "enough that it ran and was told. Exits with 1 if the stop did not reach a node. Exits with 4 if nobody knows: the "
    "daemon of a node does not answer, or its CPU was told and is silent, or did not run and comes up without the "
    "stop.";

nlohmann::json json_of(const std::vector<ask::KnownStop>& stops) {
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
    stop_.nodes = ring.nodes();
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
  answer["nodes"] = json_of(stops);
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

namespace {

constexpr std::chrono::seconds kAnswer{10};  // a send ends after timeouts.queue and its tries

struct ResumeOptions {
  std::string node = "all", from;
  bool json = false;
};

/// For "all": the nodes with joints, here and on other hosts, and all that say that a stop is latched; as in the ROS
/// service `resume`.
std::vector<NodeName> meant(const RingAccess& ring, HostPort& port, const std::string& which,
                            const std::vector<ask::Node>& latched) {
  if (which != "all") return {ring.node(which)};
  std::set<std::uint8_t> ids;
  const nlohmann::json config = ask(port, {{"do", "config"}}, kAnswerTime);
  for (const auto& node : config.at("nodes"))
    if (node.value("joints", 0) > 0) ids.insert(node.at("id").get<std::uint8_t>());
  for (const ask::Node& node : latched) ids.insert(node.id);
  std::vector<NodeName> nodes;
  for (const NodeName& node : ring.nodes())
    if (ids.count(node.id) != 0) nodes.push_back(node);
  if (nodes.empty()) throw NotDone("no node of ring " + ring.ring() + " has joints, and none is stopped");
  return nodes;
}

/// From `port`; if that does not reach the node, and the user leaves it to us, from a node that does.
Result send_resume(const RingAccess& ring, HostPort& port, std::uint8_t node, bool from_is_free) {
  const Result result = ask::resume_cpu(port, node, kAnswer);
  if (!from_is_free) return result;
  return ask::resume_from_nearer(ring.ring(), node, result, [&](std::uint8_t sender) {
    HostPort nearer = ring.connect(ring.node(std::to_string(sender)));
    return ask::resume_cpu(nearer, node, kAnswer);
  });
}

int code_of(const std::vector<ask::Resumed>& all) {
  std::vector<Result> open;
  for (const ask::Resumed& one : all) {
    if (one.is_latched) return kNotDone;
    if (!one.done()) open.push_back(one.result);
  }
  return exit_code(open);
}

void print_json(const std::vector<ask::Resumed>& all) {
  nlohmann::json list = nlohmann::json::array();
  for (const ask::Resumed& one : all) {
    list.push_back(to_json(one.result));
    list.back().update({{"id", one.node.id}, {"name", one.node.name}, {"stop_latched", one.is_latched}});
    list.back()["resumed"] = one.done();
  }
  std::cout << nlohmann::json{{"nodes", list}}.dump(2) << '\n';
}

/// What else ends the stop at a node that no other one reaches: the first of an open chain.
std::string way_out(const ask::Resumed& one) {
  if (one.result.outcome != Outcome::unconfirmed || one.result.why != Reason::out_of_reach) return "";
  return "; " + ask::way_to_first_of_chain(one.node.name);
}

void print_text(const std::vector<ask::Resumed>& all, bool from_is_free) {
  std::size_t done = 0;
  for (const ask::Resumed& one : all) {
    if (one.is_latched && one.result.outcome == Outcome::delivered)
      std::cout << ask::sentence_of_latched(one.node) << '\n';
    else if (!one.done())
      std::cout << one.node.name << ": the resume " << ended_text(one.result) << (from_is_free ? way_out(one) : "")
                << '\n';
    else
      ++done;
  }
  if (done != all.size()) {
    if (done != 0) std::cout << "resumed " << done << " of " << all.size() << " nodes\n";
    return;
  }
  std::cout << "resumed " << (done == 1 ? all[0].node.name : std::to_string(done) + " nodes") << '\n';
}

int run(const Context& context, const ResumeOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  HostPort port = ring.connect(ring.source(options.from));
  const std::vector<ask::Node> latched = ask::nodes_with_latched_stop(ring.ring(), ring.nodes());
  std::vector<ask::Resumed> all;
  for (const NodeName& node : meant(ring, port, options.node, latched))
    while_telling(ring.ring(), [&] {
      all.push_back({{node.id, node.name},
                     send_resume(ring, port, node.id, options.from.empty()),
                     ask::is_among(latched, node.id)});
    });
  ask::look_at(ring.ring(), ring.nodes(), all);
  if (options.json)
    print_json(all);
  else
    print_text(all, options.from.empty());
  return code_of(all);
}

}  // namespace

void add_resume(CLI::App& app, Context& context) {
  auto options = std::make_shared<ResumeOptions>();
  CLI::App* command = add_command(app, "resume", "End a stop: joints obey the next command again", "ringctl resume");
  command->add_option("NODE", options->node, "Node, id or name, or all (default): all that have joints or are stopped");
  command->add_option("--from", options->from,
                      "Node that sends; default: the first that answers, in an open ring one that reaches NODE");
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

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
  query.nodes = ring.nodes();
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
