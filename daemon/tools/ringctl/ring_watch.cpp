#include "tools/ringctl/ring_watch.h"

#include "tools/ringctl/answers.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {

using status::NodeRow;

namespace {

std::string knows_ring_of(std::size_t size) { return "it knows a ring of " + std::to_string(size) + " nodes"; }

/// What may be the reason.
std::string warning_of(const NodeRow& row) {
  std::string all;
  for (const status::Warning& warning : row.warnings) all += (all.empty() ? "" : "; ") + warning.text;
  return all.empty() ? "" : " (" + all + ")";
}

/// Also after a stop it runs.
std::string lack_of_cpu(const NodeRow& row) {
  const std::string word = cpu_word(row), why = row.cpu.last_exit.value_or("");
  if (row.cpu.kind != "child" || word == "running" || word == "stopped") return {};
  return "its CPU is " + word + (why.empty() ? "" : " (" + why + ")");
}

/// Of one on another host: its beacons say no more.
std::string lack_elsewhere(const NodeRow& row) {
  const std::string word = cpu_word(row);
  return word == "booting" || word == "failed" ? "its CPU is " + word : "";
}

std::string not_there(const ask::ToldRow& told) { return told.why_not.empty() ? "it is frozen" : told.why_not; }

}  // namespace

std::string lack_of_node(const NodeRow& row, std::size_t nodes) {
  if (!row.unanswered.empty()) return "it has not answered: " + row.unanswered;
  if (row.state != "up") return "it is " + row.state + warning_of(row);
  if (row.elsewhere) return lack_elsewhere(row);
  const std::size_t size = row.ring_size.value_or(0);
  if (size != nodes) return knows_ring_of(size) + ", not " + std::to_string(nodes);
  if (row.fold && row.fold->second_input != "up") return "its second line in is broken";
  return lack_of_cpu(row);
}

std::string lack_in_part(const NodeRow& row, std::size_t nodes) {
  const std::string& state = row.state;
  if (state == "starting" || state == "joining" || state == "duplicate_id") return "it is " + state + warning_of(row);
  const std::size_t size = row.ring_size.value_or(0);
  if (state != "open_chain" && size < nodes)
    return knows_ring_of(size) + "; " + std::to_string(nodes) + " are on this host";
  return lack_of_cpu(row);
}

RingWatch::RingWatch(const RingPlan& plan) : plan_(plan), client_(plan.ring, plan.nodes, Stay::for_long) {}

std::optional<RingWatch::NotReady> RingWatch::first_not_ready() {
  const auto told = client_.status(std::chrono::steady_clock::now() + kAnswerTime);
  refusal_.clear();
  std::optional<NotReady> first;
  for (std::size_t i = 0; i < told.size(); ++i) {
    const auto& row = told[i].said;
    if (row) ring_size_ = row->ring_size.value_or(0);
    if (row && refusal_.empty() && !row->refusals.empty()) refusal_ = "; " + row->refusals.front().text;
    const std::string lack =
        row ? (plan_.is_part() ? lack_in_part : lack_of_node)(*row, told.size()) : not_there(told[i]);
    if (!first && !lack.empty()) first = NotReady{i, "node " + label(plan_.nodes[i]) + ": " + lack};
  }
  if (first) first->lack += refusal_;
  return first;
}

}  // namespace limb_ring::ringctl
