#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <set>

#include "app/ringctl/answers.h"
#include "app/ringctl/choose_ring.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/progress.h"
#include "app/ringctl/results.h"
#include "ask/arrived.h"
#include "ask/known_stops.h"
#include "ask/resume_cpu.h"

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

bool is_among(const std::vector<ask::Node>& nodes, std::uint8_t id) {
  return std::any_of(nodes.begin(), nodes.end(), [id](const ask::Node& node) { return node.id == id; });
}

/// What came of the resume of one node.
struct Resumed {
  NodeName node;
  Result result;
  bool was_latched = false, is_latched = false;
  bool seen = false;  ///< its daemon, or a beacon of it, tells that no stop is latched there any more

  bool done() const { return !is_latched && (result.outcome == Outcome::delivered || (was_latched && seen)); }
};

/// From `port`; where that does not reach the node, and the user leaves it to us, from a node that does.
Result send_resume(const RingAccess& ring, HostPort& port, const NodeName& node, bool from_is_free) {
  const Result result = ask::resume_cpu(port, node.id, kAnswer);
  const bool elsewhere = result.why == Reason::out_of_reach || result.outcome == Outcome::no_such_node;
  if (!from_is_free || !elsewhere) return result;
  const auto sender = ask::who_reaches(ask::status_rows_here(ring.ring(), ask::kRowTimeout), node.id);
  if (!sender) return result;
  HostPort nearer = ring.connect(ring.node(std::to_string(*sender)));
  const Result again = ask::resume_cpu(nearer, node.id, kAnswer);
  return ask::may_have_arrived(again) ? again : result;
}

/// Fills in what can be seen of it: of a command that was not confirmed, it alone tells.
void look_at(const RingAccess& ring, std::vector<Resumed>& all) {
  std::vector<ask::Node> taken;
  for (const Resumed& one : all)
    if (ask::may_have_arrived(one.result)) taken.push_back({one.node.id, one.node.name});
  ask::wait_for_resumes(ring.ring(), taken);
  std::map<std::uint8_t, ask::StopState> known;
  for (const ask::KnownStop& stop : ask::stops_now(ring.ring(), ring.ask_nodes())) known[stop.node.id] = stop.state;
  for (Resumed& one : all) {
    one.is_latched = known[one.node.id] == ask::StopState::stopped;
    one.seen = !one.is_latched && known[one.node.id] != ask::StopState::unknown;
  }
}

int code_of(const std::vector<Resumed>& all) {
  std::vector<Result> open;
  for (const Resumed& one : all) {
    if (one.is_latched) return kNotDone;
    if (!one.done()) open.push_back(one.result);
  }
  return exit_code(open);
}

void print_json(const std::vector<Resumed>& all) {
  nlohmann::json list = nlohmann::json::array();
  for (const Resumed& one : all) {
    list.push_back(to_json(one.result));
    list.back().update({{"id", one.node.id}, {"name", one.node.name}, {"stop_latched", one.is_latched}});
    list.back()["resumed"] = one.done();
  }
  std::cout << nlohmann::json{{"nodes", list}}.dump(2) << '\n';
}

void print_text(const std::vector<Resumed>& all) {
  std::size_t done = 0;
  for (const Resumed& one : all) {
    if (one.is_latched && one.result.outcome == Outcome::delivered)
      std::cout << ask::sentence_of_latched({one.node.id, one.node.name}) << '\n';
    else if (!one.done())
      std::cout << one.node.name << ": the resume " << ended_text(one.result) << '\n';
    else
      ++done;
  }
  if (done != all.size()) return;
  std::cout << "resumed " << (done == 1 ? all[0].node.name : std::to_string(done) + " nodes") << '\n';
}

int run(const Context& context, const ResumeOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  HostPort port = ring.connect(ring.source(options.from));
  const std::vector<ask::Node> latched = ask::nodes_with_latched_stop(ring.ring(), ring.ask_nodes());
  std::vector<Resumed> all;
  for (const NodeName& node : meant(ring, port, options.node, latched))
    while_telling(ring.ring(), [&] {
      all.push_back({node, send_resume(ring, port, node, options.from.empty()), is_among(latched, node.id)});
    });
  look_at(ring, all);
  if (options.json)
    print_json(all);
  else
    print_text(all);
  return code_of(all);
}

}  // namespace

void add_resume(CLI::App& app, Context& context) {
  auto options = std::make_shared<ResumeOptions>();
  CLI::App* command = add_command(app, "resume", "End a latched stop: the joints obey the next command again");
  command->add_option("NODE", options->node, "Node, id or name, or all (default): those with joints or a latched stop");
  command->add_option("--from", options->from,
                      "Node that sends; default: the first that answers, in an open ring one that reaches NODE");
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
