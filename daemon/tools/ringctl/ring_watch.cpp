#include "tools/ringctl/ring_watch.h"

#include "tools/ringctl/answers.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

std::string knows_ring_of(std::size_t size) { return "it knows a ring of " + std::to_string(size) + " nodes"; }

/// What may be the reason.
std::string warning_of(const json& row) {
  std::string all;
  for (const json& warning : row.value("warnings", json::array()))
    all += (all.empty() ? "" : "; ") + warning.at("text").get<std::string>();
  return all.empty() ? "" : " (" + all + ")";
}

/// Also after a stop it runs.
std::string lack_of_cpu(const json& row) {
  const json cpu = row.value("cpu", json::object());
  const std::string word = cpu_word(row);
  if (cpu.value("kind", "") != "child" || word == "running" || word == "stopped") return {};
  const json last_exit = cpu.value("last_exit", json());
  const std::string why = last_exit.is_string() ? last_exit.get<std::string>() : "";
  return "its CPU is " + word + (why.empty() ? "" : " (" + why + ")");
}

/// Of one on another host: its beacons say no more.
std::string lack_elsewhere(const json& row) {
  const std::string word = cpu_word(row);
  return word == "booting" || word == "failed" ? "its CPU is " + word : "";
}

}  // namespace

std::string lack_of_node(const json& row, std::size_t nodes) {
  const std::string state = row.value("state", "unknown");
  if (row.contains("unanswered")) return "it has not answered: " + row.value("unanswered", "");
  if (state != "up") return "it is " + state + warning_of(row);
  if (row.value("elsewhere", false)) return lack_elsewhere(row);
  const std::size_t size = row.value("ring_size", std::size_t{0});
  if (size != nodes) return knows_ring_of(size) + ", not " + std::to_string(nodes);
  if (row.value(json::json_pointer("/fold/second_input"), "up") != "up") return "its second line in is broken";
  return lack_of_cpu(row);
}

std::string lack_in_part(const json& row, std::size_t nodes) {
  const std::string state = row.value("state", "unknown");
  if (state == "starting" || state == "joining" || state == "duplicate_id") return "it is " + state + warning_of(row);
  const std::size_t size = row.value("ring_size", std::size_t{0});
  if (state != "open_chain" && size < nodes)
    return knows_ring_of(size) + "; " + std::to_string(nodes) + " are on this host";
  return lack_of_cpu(row);
}

RingWatch::RingWatch(const RingPlan& plan) : plan_(plan) { ports_.resize(plan.nodes.size()); }

std::optional<RingWatch::NotReady> RingWatch::first_not_ready() {
  for (std::size_t i = 0; i < plan_.nodes.size(); ++i) {
    const std::string lack = lack_of(i);
    if (!lack.empty()) return NotReady{i, "node " + label(plan_.nodes[i]) + ": " + lack + refusal()};
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
    const json status = port ? ask(*port, {{"do", "status"}}, kAnswerTime) : json::object();
    return wrong_in_row(status, plan_.nodes[index].id).empty() ? status : json::object();
  } catch (const std::exception&) {
    port.reset();
    return json::object();
  }
}

std::string RingWatch::lack_of(std::size_t index) {
  auto& port = ports_[index];
  try {
    if (!port) port.emplace(connect_node(plan_.ring, std::to_string(plan_.nodes[index].id)));
    const json status = ask(*port, {{"do", "status"}}, kAnswerTime);
    const std::string wrong = wrong_in_row(status, plan_.nodes[index].id);
    if (!wrong.empty()) return sentence_of_shape(wrong);
    ring_size_ = status.value("ring_size", std::size_t{0});
    return (plan_.is_part() ? lack_in_part : lack_of_node)(status, plan_.nodes.size());
  } catch (const std::exception& problem) {
    port.reset();
    return problem.what();
  }
}

}  // namespace limb_ring::ringctl
