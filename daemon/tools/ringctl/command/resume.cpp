#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <set>

#include "ring/known_stops.h"
#include "ring/resume_cpu.h"
#include "ring/resumed.h"
#include "ring/ring_words.h"
#include "tools/ringctl/answers.h"
#include "tools/ringctl/choose_ring.h"
#include "tools/ringctl/command/commands.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/progress.h"
#include "tools/ringctl/results.h"

namespace limb_ring::ringctl {

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
  if (nodes.empty()) throw NotDone("no node of ring " + ring.ring() + " has joints, and at none a stop is latched");
  return nodes;
}

/// From `port`; where that does not reach the node, and the user leaves it to us, from a node that does.
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
  const std::vector<ask::Node> latched = ask::nodes_with_latched_stop(ring.ring(), ring.ask_nodes());
  std::vector<ask::Resumed> all;
  for (const NodeName& node : meant(ring, port, options.node, latched))
    while_telling(ring.ring(), [&] {
      all.push_back({{node.id, node.name},
                     send_resume(ring, port, node.id, options.from.empty()),
                     ask::is_among(latched, node.id)});
    });
  ask::look_at(ring.ring(), ring.ask_nodes(), all);
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

}  // namespace limb_ring::ringctl
