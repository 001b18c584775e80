#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/ringctl/answers.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/results.h"
#include "ask/resume_cpu.h"

namespace limb_ring::ringctl {

namespace {

constexpr std::chrono::seconds kAnswer{10};  // a send ends after timeouts.queue and its tries

struct Options {
  std::string node = "all", from;
  bool json = false;
};

/// Those that have joints, as the ROS service `resume` takes them.
std::vector<NodeName> meant(const RingAccess& ring, HostPort& port, const std::string& which) {
  if (which != "all") return {ring.node(which)};
  std::vector<NodeName> nodes;
  const nlohmann::json config = ask(port, {{"do", "config"}}, kAnswerTime);
  for (const auto& node : config.at("nodes"))
    if (node.value("joints", 0) > 0) nodes.push_back({node.at("id"), node.at("name")});
  if (nodes.empty()) throw NotDone("no node of ring " + ring.ring() + " has joints");
  return nodes;
}

int run(const Context& context, const Options& options) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring), options.from);
  HostPort port = ring.connect(ring.source(options.from));
  std::vector<Result> results;
  nlohmann::json list = nlohmann::json::array();
  for (const NodeName& node : meant(ring, port, options.node)) {
    results.push_back(ask::resume_cpu(port, node.id, kAnswer));
    nlohmann::json row = to_json(results.back());
    row["id"] = node.id;
    row["name"] = node.name;
    list.push_back(row);
    if (!options.json && results.back().outcome != Outcome::delivered)
      std::cout << node.name << ": " << to_text(results.back()) << '\n';
  }
  const int code = exit_code(results);
  if (options.json) std::cout << nlohmann::json{{"nodes", list}}.dump(2) << '\n';
  else if (code == kDone) std::cout << "resumed " << (results.size() == 1 ? list[0]["name"].get<std::string>()
                                                                         : std::to_string(results.size()) + " nodes")
                                    << '\n';
  return code;
}

}  // namespace

void add_resume(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(app, "resume", "End a latched stop: the joints obey the next command again");
  command->add_option("NODE", options->node, "Node, id or name, or all that have joints (default)");
  command->add_option("--from", options->from, "Node that sends; default: the first that answers");
  add_json(*command, options->json);
  command->callback([&context, options] {
    context.action = [&context, options] { return run(context, *options); };
  });
}

}  // namespace limb_ring::ringctl
