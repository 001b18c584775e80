#include "ask/known_stops.h"

#include <algorithm>
#include <optional>
#include <thread>

#include "limb_ring/ring_directory.h"
#include "live/lock_files.h"

namespace limb_ring::ask {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kStopsPollPeriod{20};
constexpr milliseconds kToSaySo{1000};
constexpr milliseconds kUnderWay{200};

json stop_in(const json& row) { return row.value("cpu", json::object()).value("stop", json::object()); }

/// How long ago its stop pin was pulled; null: never.
json pulled_ms(const json& row) { return stop_in(row).value("pulled_ms", json()); }

StopState state_in(const json& row, milliseconds age) {
  if (stop_in(row).value("latched", false)) return StopState::stopped;
  const std::string state = row.value("cpu", json::object()).value("state", "");
  if (state == "absent" || state == "failed" || state == "none") return StopState::no_cpu;
  const json pulled = pulled_ms(row);
  return pulled.is_number() && pulled <= age.count() ? StopState::told : StopState::not_reached;
}

StopState state_in_beacon(const json& heard, bool delivered) {
  if (heard.is_null()) return StopState::unknown;
  if (heard.value("stop_latched", false)) return StopState::stopped;
  const std::string cpu = heard.value("cpu_state", "");
  if (cpu == "absent" || cpu == "failed" || cpu == "none") return StopState::no_cpu;
  return delivered ? StopState::told : StopState::unknown;
}

bool is_on_virtual_ring(const std::string& ring, const std::vector<Node>& nodes) {
  return !nodes.empty() && live::holder_of(ring_directory(ring), nodes.front().id).on_virtual_ring;
}

std::string names_in(const std::vector<KnownStop>& stops, StopState state) {
  std::string names;
  for (const KnownStop& stop : stops)
    if (stop.state == state) names += (names.empty() ? "" : ", ") + stop.node.name;
  return names;
}

std::string group(const std::vector<KnownStop>& stops, StopState state, const char* words) {
  const std::string names = names_in(stops, state);
  return names.empty() ? "" : std::string("; ") + words + ": " + names;
}

}  // namespace

const char* to_string(StopState state) {
  switch (state) {
    case StopState::stopped:
      return "stopped";
    case StopState::told:
      return "told";
    case StopState::no_cpu:
      return "no_cpu";
    case StopState::not_reached:
      return "not_reached";
    case StopState::unknown:
      return "unknown";
  }
  return "";
}

std::vector<KnownStop> known_stops(const std::vector<Node>& nodes, const Rows& rows, milliseconds age, bool delivered) {
  std::vector<KnownStop> stops;
  for (const Node& node : nodes) {
    const auto row = rows.find(node.id);
    stops.push_back({node, row == rows.end() ? state_in_beacon(lately_heard(rows, node.id), delivered)
                                             : state_in(row->second, age)});
  }
  return stops;
}

milliseconds age_on_virtual_ring(const Rows& rows, milliseconds age) {
  std::optional<milliseconds> last;
  for (const auto& [id, row] : rows) {
    const json pulled = pulled_ms(row);
    if (!pulled.is_number()) continue;
    const milliseconds ago(pulled.get<std::int64_t>());
    last = std::min(last.value_or(ago), ago);
  }
  return age + last.value_or(milliseconds(0));
}

std::vector<KnownStop> wait_for_stops(const std::string& ring, const std::vector<Node>& nodes,
                                      steady_clock::time_point sent, bool delivered) {
  const auto begun = steady_clock::now();
  const bool by_ring_clock = delivered && is_on_virtual_ring(ring, nodes);
  for (;;) {
    const Rows rows = status_rows_here(ring, kRowTimeout);
    auto age = std::chrono::ceil<milliseconds>(steady_clock::now() - sent);
    if (by_ring_clock) age = age_on_virtual_ring(rows, age);
    const std::vector<KnownStop> stops = known_stops(nodes, rows, age, delivered);
    const auto waited = steady_clock::now() - begun;
    const auto pending = [&](const KnownStop& stop) {
      const bool may_say_so = stop.state == StopState::told ||
                              (stop.state == StopState::unknown && !lately_heard(rows, stop.node.id).is_null());
      return (may_say_so && waited < kToSaySo) || (stop.state == StopState::not_reached && waited < kUnderWay);
    };
    if (std::none_of(stops.begin(), stops.end(), pending)) return stops;
    std::this_thread::sleep_for(kStopsPollPeriod);
  }
}

std::vector<Node> nodes_with_latched_stop(const std::string& ring, const std::vector<Node>& nodes) {
  std::vector<Node> latched;
  for (const KnownStop& stop : known_stops(nodes, status_rows_here(ring, kRowTimeout), milliseconds(0)))
    if (stop.state == StopState::stopped) latched.push_back(stop.node);
  return latched;
}

std::vector<Node> wait_for_resumes(const std::string& ring, const std::vector<Node>& nodes) {
  if (nodes.empty()) return {};
  const auto begun = steady_clock::now();
  for (;;) {
    std::vector<Node> latched = nodes_with_latched_stop(ring, nodes);
    if (latched.empty() || steady_clock::now() - begun >= kToSaySo) return latched;
    std::this_thread::sleep_for(kStopsPollPeriod);
  }
}

std::string sentence_of_latched(const Node& node) {
  return node.name +
         ": a stop is still latched there, though its node has taken the resume: the CPU read it too late, " +
         "or there was another stop";
}

bool all_told(const std::vector<KnownStop>& stops) {
  return std::none_of(stops.begin(), stops.end(), [](const KnownStop& stop) {
    return stop.state == StopState::not_reached || stop.state == StopState::unknown;
  });
}

std::string sentence_of(const std::vector<KnownStop>& stops) {
  const auto stopped =
      std::count_if(stops.begin(), stops.end(), [](const KnownStop& stop) { return stop.state == StopState::stopped; });
  return std::to_string(stopped) + " of " + std::to_string(stops.size()) + " stopped" +
         group(stops, StopState::told, "told, but the CPU does not say whether it has stopped") +
         group(stops, StopState::no_cpu, "no CPU to stop") + group(stops, StopState::not_reached, "not reached") +
         group(stops, StopState::unknown, "not known, the daemon does not answer");
}

}  // namespace limb_ring::ask
