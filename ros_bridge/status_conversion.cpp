
#include "ros_bridge/status_conversion.h"

namespace limb_ring::bridge {
namespace {

constexpr double kMicroseconds = 1e-6;

/// What its daemon has found to be wrong with its CPU's firmware.
std::string problem_in(const std::vector<status::Warning>& warnings) {
  std::string problem;
  for (const status::Warning& warning : warnings)
    if (warning.rule.rfind("cpu_", 0) == 0) problem += (problem.empty() ? "" : "; ") + warning.text;
  return problem;
}

void take_lines(const status::NodeRow& row, NodeStatus& status) {
  if (row.input) {
    status.input_state = row.input->state;
    if (row.input->from) status.input_from = *row.input->from;
  }
  if (row.output) {
    status.output_state = row.output->state;
    if (row.output->to) status.output_to = *row.output->to;
    status.output_rate = static_cast<double>(row.output->rate_bit_s.value_or(0));
  }
  if (row.fold) status.second_input_state = row.fold->second_input;
  if (!row.broken_line) return;
  status.broken_before = row.broken_line->before;
  status.broken_behind = row.broken_line->behind;
}

}  // namespace

NodeStatus unheard_node(const config::NodeConfig& node) {
  NodeStatus status;
  status.id = node.id;
  status.name = node.name;
  status.state = "down";
  status.cpu_state = "unknown";
  status.beacon_age = -1;
  status.input_state = status.output_state = "unknown";
  status.input_from = status.output_to = status.broken_before = status.broken_behind = -1;
  return status;
}

void merge_status_row(const status::NodeRow& row, NodeStatus& status) {
  status.state = row.state;
  status.pid = row.pid.value_or(0);
  status.ring_size = static_cast<std::uint16_t>(row.ring_size.value_or(0));
  status.cpu_state = row.cpu.hung == true ? "hung" : row.cpu.state;
  status.cpu_pid = row.cpu.pid.value_or(0);
  status.cpu_boots = row.cpu.boots.value_or(0);
  status.stopped = row.cpu.stopped();
  take_lines(row, status);
  status.round_trip_p50 = row.round_trip_us.p50.value_or(0) * kMicroseconds;
  status.round_trip_p99 = row.round_trip_us.p99.value_or(0) * kMicroseconds;
  status.round_trip_max = row.round_trip_us.max.value_or(0) * kMicroseconds;
  for (const status::Refusal& refusal : row.refusals) status.refusals.push_back(refusal.text);
  status.problem = problem_in(row.warnings);
  for (const auto& [name, value] : row.counters) {
    status.counter_names.push_back(name);
    status.counter_values.push_back(value);
  }
}

void merge_beacon(const status::Heard& heard, std::chrono::milliseconds fresh, NodeStatus& status) {
  const bool is_heard = heard.age_ms <= fresh.count();
  if (is_heard && status.state == "down") status.state = "up";
  if (is_heard && status.cpu_state == "unknown") status.cpu_state = heard.cpu_state();
  if (is_heard && status.pid == 0) status.stopped = heard.beacon.stop_latched;
  if (status.cpu_boots == 0) status.cpu_boots = heard.beacon.cpu_boots;
  status.hop = static_cast<std::uint16_t>(heard.hop);
  status.beacon_age = static_cast<double>(heard.age_ms) / 1000;
}

}  // namespace limb_ring::bridge
