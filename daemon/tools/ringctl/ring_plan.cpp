#include "tools/ringctl/ring_plan.h"

#include <cmath>
#include <filesystem>

#include "config/config_error.h"
#include "config/load_ring.h"
#include "config/plain_ring.h"
#include "config/recorder_saves.h"
#include "io/find_program.h"
#include "limb_ring/ring_directory.h"
#include "tools/common/ring_file.h"
#include "tools/ringctl/host_choice.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/tell_user.h"

namespace limb_ring::ringctl {

namespace {

constexpr const char* kPlainRing = "plain";

config::RingConfig load(const UpRequest& request) {
  if (request.config.empty())
    return config::plain_ring(request.ring.empty() ? kPlainRing : request.ring, request.nodes);
  config::RingConfig config = config::load_ring(request.config);
  if (request.nodes != 0 && request.nodes != config.nodes.size())
    throw UsageError("--nodes is " + std::to_string(request.nodes) + ", but " + request.config + " has " +
                     std::to_string(config.nodes.size()) + " nodes; make them the same, or leave the number out");
  return config;
}

std::string ring_name(const UpRequest& request, const config::RingConfig& config) {
  const std::string name = request.ring.empty() ? config.ring : request.ring;
  try {
    socket_path(ring_directory(name), "255", "host");
  } catch (const std::invalid_argument& problem) {
    throw UsageError(problem.what());
  }
  return name;
}

std::string pace_argument(double pace) { return std::isinf(pace) ? "max" : std::to_string(pace); }

std::vector<std::string> daemon_arguments(const UpRequest& request, const std::string& ring, std::size_t nodes) {
  std::vector<std::string> arguments;
  if (request.config.empty())
    arguments = {"--nodes", std::to_string(nodes)};
  else
    arguments = {"--config", std::filesystem::absolute(request.config).string(), "--as-read", ring_directory(ring)};
  arguments.insert(arguments.end(), {"--ring", ring});
  if (!request.transport.empty()) arguments.insert(arguments.end(), {"--transport", request.transport});
  if (request.record) arguments.push_back("--record");
  if (!request.clock) return arguments;
  arguments.insert(arguments.end(), {"--clock", request.clock->follows ? "follow" : "virtual", "--pace",
                                     pace_argument(request.clock->pace)});
  if (request.clock->lasts_s > 0) arguments.insert(arguments.end(), {"--for", std::to_string(request.clock->lasts_s)});
  if (!request.clock->capture.empty())
    arguments.insert(arguments.end(), {"--capture", std::filesystem::absolute(request.clock->capture).string()});
  return arguments;
}

std::vector<std::string> keeper_arguments(const config::RecorderSaves& saves, const std::string& ring) {
  if (saves.when.empty()) return {};
  std::string when;
  for (const std::string& word : saves.when) when += (when.empty() ? "" : ",") + word;
  return {"--ring", ring, "record", "keep", saves.folder, "--when", when, "--keep", std::to_string(saves.keep)};
}

}  // namespace

std::vector<std::string> RingPlan::arguments_of(const NodeName& node) const {
  std::vector<std::string> all = arguments;
  all.insert(all.end(), {"--node", std::to_string(node.id)});
  return all;
}

live::LaunchRequest launch_request(const RingPlan& plan, process::Lifetime lifetime) {
  live::LaunchRequest request;
  request.ring = plan.ring;
  if (plan.is_virtual) {
    const NodeName& first = plan.nodes.front();
    request.nodes.push_back({wire::NodeId{first.id}, first.name, plan.arguments, true});
  } else {
    for (const NodeName& node : plan.nodes)
      request.nodes.push_back({wire::NodeId{node.id}, node.name, plan.arguments_of(node)});
  }
  request.lifetime = lifetime;
  request.logged = lifetime != process::Lifetime::asked_to_end;
  return request;
}

/// The program of a node's CPU that is not there; empty where it is.
std::string missing_program(const config::RingConfig& config, const config::NodeConfig& node) {
  if (node.cpu.kind != config::CpuConfig::Kind::child || node.cpu.command.empty()) return "";
  const std::string& name = node.cpu.command.front();
  if (!process::find_program(name).empty()) return "";
  return config.path + ": the CPU of node " + node.name + ": " + process::no_program(name);
}

RingPlan plan_ring(const UpRequest& given) {
  if (given.config.empty() && given.nodes == 0)
    throw UsageError("give CONFIG, the ring's YAML file or its name, or --nodes N for a plain ring");
  UpRequest request = given;
  if (!given.config.empty()) request.config = app::ring_file(given.config);
  const config::RingConfig config = load(request);
  for (const std::string& warning : config.warnings) tell_user("warning: " + warning);
  RingPlan plan;
  plan.ring = ring_name(request, config);
  plan.is_virtual = request.clock.has_value();
  plan.arguments = daemon_arguments(request, plan.ring, config.nodes.size());
  plan.files = config.files;
  plan.ring_size = config.nodes.size();
  if (!plan.is_virtual && !request.config.empty()) {
    const bool records = config.recorder.enabled || request.record;
    const config::RecorderSaves saves = config::load_recorder_saves(request.config, records);
    plan.keeper = keeper_arguments(saves, plan.ring);
    plan.saves = saves.folder;
  }
  if (!plan.is_virtual) plan.host = chosen_host(config, request.host);
  if (plan.host == kAllHosts) {
    plan.host.clear();
    plan.arguments.push_back("--one-host");
  }
  for (const auto& node : config.nodes) {
    const bool foreign = node.controller == config::NodeConfig::Controller::foreign && !plan.is_virtual;
    if (foreign || (!plan.host.empty() && config.host_of(node)->name != plan.host)) continue;
    if (plan.missing_program.empty()) plan.missing_program = missing_program(config, node);
    plan.nodes.push_back({node.id, node.name});
  }
  if (plan.nodes.empty())
    throw UsageError("ring " + plan.ring + ": all its nodes here are foreign; there is nothing to start");
  return plan;
}

}  // namespace limb_ring::ringctl
