#include "app/ringctl/ring_watch.h"

#include "app/ringctl/answers.h"
#include "app/ringctl/connect_node.h"
#include "app/ringctl/node_name.h"

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

std::string cpu_missing(const json& cpu) {
  const std::string state = cpu.value("state", "unknown");
  if (state == "running") return {};
  const std::string why =
      cpu.contains("last_exit") && cpu["last_exit"].is_string() ? cpu["last_exit"].get<std::string>() : "";
  return "its CPU is " + state + (why.empty() ? "" : " (" + why + ")");
}

}  // namespace

std::string missing(const PlannedNode& planned, const json& status, std::size_t nodes) {
  const std::string state = status.value("state", "unknown");
  if (state != "up") return "it is " + state;
  const std::size_t size = status.value("ring_size", std::size_t{0});
  if (size != nodes) return "it knows a ring of " + std::to_string(size) + " nodes, not " + std::to_string(nodes);
  return planned.has_child ? cpu_missing(status.value("cpu", json::object())) : "";
}

std::string missing_in_part(const PlannedNode& planned, const json& status, std::size_t nodes) {
  const std::string state = status.value("state", "unknown");
  if (state == "starting" || state == "joining" || state == "duplicate_id") return "it is " + state;
  const std::size_t size = status.value("ring_size", std::size_t{0});
  if (state != "open_chain" && size < nodes)
    return "it knows a ring of " + std::to_string(size) + " nodes; " + std::to_string(nodes) + " are on this host";
  return planned.has_child ? cpu_missing(status.value("cpu", json::object())) : "";
}

RingWatch::RingWatch(const RingPlan& plan) : plan_(plan) { ports_.resize(plan.nodes.size()); }

std::optional<RingWatch::NotReady> RingWatch::first_not_ready() {
  for (std::size_t i = 0; i < plan_.nodes.size(); ++i) {
    const std::string lack = lack_of(i);
    if (!lack.empty()) return NotReady{i, "node " + label(plan_.nodes[i].node) + ": " + lack + refusal()};
  }
  return std::nullopt;
}

std::string RingWatch::refusal() {
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    const json row = status_of(i);
    for (const json& refusal : row.value("refusals", json::array())) return "; " + refusal.value("text", "");
  }
  return {};
}

json RingWatch::status_of(std::size_t index) {
  auto& port = ports_[index];
  try {
    return port ? ask(*port, {{"do", "status"}}, kAnswerTime) : json::object();
  } catch (const std::exception&) {
    port.reset();
    return json::object();
  }
}

std::string RingWatch::lack_of(std::size_t index) {
  auto& port = ports_[index];
  const PlannedNode& planned = plan_.nodes[index];
  try {
    if (!port) port.emplace(connect_node(plan_.ring, std::to_string(planned.node.id)));
    const json status = ask(*port, {{"do", "status"}}, kAnswerTime);
    ring_size_ = status.value("ring_size", std::size_t{0});
    return (plan_.is_part() ? missing_in_part : missing)(planned, status, plan_.nodes.size());
  } catch (const std::exception& problem) {
    port.reset();
    return problem.what();
  }
}

}  // namespace limb_ring::ringctl
