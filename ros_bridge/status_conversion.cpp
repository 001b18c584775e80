
#include "ros_bridge/status_conversion.h"

namespace limb_ring::bridge {
namespace {

using nlohmann::json;

const json& member(const json& object, const char* name) {
  static const json nothing;
  if (!object.is_object()) return nothing;
  const auto found = object.find(name);
  return found == object.end() ? nothing : *found;
}

template <typename Field>
void take_number(const json& object, const char* name, Field& field, double scale = 1) {
  const json& value = member(object, name);
  if (!value.is_number()) return;
  if (scale == 1 && value.is_number_integer())
    field = static_cast<Field>(value.get<std::int64_t>());
  else
    field = static_cast<Field>(value.get<double>() * scale);
}

void take_truth(const json& object, const char* name, std::uint8_t& field) {
  const json& value = member(object, name);
  if (value.is_boolean()) field = value.get<bool>();
}

void take_text(const json& object, const char* name, std::string& field) {
  const json& value = member(object, name);
  if (value.is_string()) field = value.get<std::string>();
}

void take_counters(const json& counters, NodeStatus& status) {
  if (!counters.is_object()) return;
  status.counter_names.clear();
  status.counter_values.clear();
  for (const auto& [name, value] : counters.items()) {
    if (!value.is_number_integer()) continue;
    status.counter_names.push_back(name);
    status.counter_values.push_back(value.get<std::uint64_t>());
  }
}

void take_refusals(const json& refusals, NodeStatus& status) {
  status.refusals.clear();
  if (!refusals.is_array()) return;
  for (const json& refusal : refusals) {
    const json& text = member(refusal, "text");
    if (text.is_string()) status.refusals.push_back(text.get<std::string>());
  }
}

/// What its daemon has found to be wrong with its CPU's firmware.
void take_cpu_warnings(const json& warnings, NodeStatus& status) {
  status.problem.clear();
  if (!warnings.is_array()) return;
  for (const json& warning : warnings) {
    const json &rule = member(warning, "rule"), &text = member(warning, "text");
    if (!rule.is_string() || !text.is_string() || rule.get<std::string>().rfind("cpu_", 0) != 0) continue;
    status.problem += (status.problem.empty() ? "" : "; ") + text.get<std::string>();
  }
}

void take_lines(const json& row, NodeStatus& status) {
  const json& input = member(row, "input");
  take_text(input, "state", status.input_state);
  take_number(input, "from", status.input_from);
  const json& output = member(row, "output");
  take_text(output, "state", status.output_state);
  take_number(output, "to", status.output_to);
  take_number(output, "rate_bit_s", status.output_rate);
  take_text(member(row, "fold"), "second_input", status.second_input_state);
  const json& broken = member(row, "broken_line");
  take_number(broken, "before", status.broken_before);
  take_number(broken, "behind", status.broken_behind);
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

void merge_status_row(const json& row, NodeStatus& status) {
  constexpr double kMicroseconds = 1e-6;
  take_text(row, "state", status.state);
  take_number(row, "pid", status.pid);
  take_number(row, "ring_size", status.ring_size);
  const json& cpu = member(row, "cpu");
  take_text(cpu, "state", status.cpu_state);
  std::uint8_t hung = 0;
  take_truth(cpu, "hung", hung);
  if (hung != 0) status.cpu_state = "hung";
  take_number(cpu, "pid", status.cpu_pid);
  take_number(cpu, "boots", status.cpu_boots);
  take_truth(member(cpu, "stop"), "latched", status.stopped);
  take_lines(row, status);
  const json& trip = member(row, "round_trip_us");
  take_number(trip, "p50", status.round_trip_p50, kMicroseconds);
  take_number(trip, "p99", status.round_trip_p99, kMicroseconds);
  take_number(trip, "max", status.round_trip_max, kMicroseconds);
  take_refusals(member(row, "refusals"), status);
  take_cpu_warnings(member(row, "warnings"), status);
  take_counters(member(row, "counters"), status);
}

void merge_beacon(const json& heard, std::chrono::milliseconds fresh, NodeStatus& status) {
  double age_ms = 0;
  take_number(heard, "age_ms", age_ms);
  const bool is_heard = age_ms <= static_cast<double>(fresh.count());
  if (is_heard && status.state == "down") status.state = "up";
  if (is_heard && status.cpu_state == "unknown") take_text(heard, "cpu_state", status.cpu_state);
  if (is_heard && status.pid == 0) take_truth(heard, "stop_latched", status.stopped);
  if (status.cpu_boots == 0) take_number(heard, "cpu_boots", status.cpu_boots);
  take_number(heard, "hop", status.hop);
  take_number(heard, "age_ms", status.beacon_age, 1e-3);
}

}  // namespace limb_ring::bridge
