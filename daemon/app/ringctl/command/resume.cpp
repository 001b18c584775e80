#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <set>

#include "app/ringctl/answers.h"
#include "app/ringctl/choose_ring.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/progress.h"
#include "app/ringctl/results.h"
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
std::vector<NodeName> meant(const RingAccess& ring, HostPort& port, const std::string& which) {
  if (which != "all") return {ring.node(which)};
  std::set<std::uint8_t> ids;
  const nlohmann::json config = ask(port, {{"do", "config"}}, kAnswerTime);
  for (const auto& node : config.at("nodes"))
    if (node.value("joints", 0) > 0) ids.insert(node.at("id").get<std::uint8_t>());
  for (const ask::Node& node : ask::nodes_with_latched_stop(ring.ring(), ring.ask_nodes())) ids.insert(node.id);
  std::vector<NodeName> nodes;
  for (const NodeName& node : ring.nodes())
    if (ids.count(node.id) != 0) nodes.push_back(node);
  if (nodes.empty()) throw NotDone("no node of ring " + ring.ring() + " has joints, and at none a stop is latched");
  return nodes;
}

bool is_among(const std::vector<ask::Node>& nodes, std::uint8_t id) {
  return std::any_of(nodes.begin(), nodes.end(), [id](const ask::Node& node) { return node.id == id; });
}

int run(const Context& context, const ResumeOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  HostPort port = ring.connect(ring.source(options.from));
  std::vector<Result> results;
  std::vector<ask::Node> taken;
  nlohmann::json list = nlohmann::json::array();
  for (const NodeName& node : meant(ring, port, options.node)) {
    while_telling(ring.ring(), [&] { results.push_back(ask::resume_cpu(port, node.id, kAnswer)); });
    nlohmann::json row = to_json(results.back());
    row["id"] = node.id;
    row["name"] = node.name;
    list.push_back(row);
    if (results.back().outcome == Outcome::delivered) taken.push_back({node.id, node.name});
    if (!options.json && results.back().outcome != Outcome::delivered)
      std::cout << node.name << ": the resume " << ended_text(results.back()) << '\n';
  }
  const std::vector<ask::Node> latched = ask::wait_for_resumes(ring.ring(), taken);
  for (nlohmann::json& row : list) row["stop_latched"] = is_among(latched, row["id"]);
  for (const ask::Node& node : latched)
    if (!options.json) std::cout << ask::sentence_of_latched(node) << '\n';
  const int code = latched.empty() ? exit_code(results) : kNotDone;
  if (options.json)
    std::cout << nlohmann::json{{"nodes", list}}.dump(2) << '\n';
  else if (code == kDone)
    std::cout << "resumed "
              << (results.size() == 1 ? list[0]["name"].get<std::string>() : std::to_string(results.size()) + " nodes")
              << '\n';
  return code;
}

}  // namespace

void add_resume(CLI::App& app, Context& context) {
  auto options = std::make_shared<ResumeOptions>();
  CLI::App* command = add_command(app, "resume", "End a latched stop: the joints obey the next command again");
  command->add_option("NODE", options->node, "Node, id or name, or all (default): those with joints or a latched stop");
  command->add_option("--from", options->from, "Node that sends; default: the first that answers");
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
