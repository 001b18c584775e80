#include "app/ringctl/status_rows.h"

#include <algorithm>

#include "app/ringctl/answers.h"
#include "app/ringctl/supervision.h"
#include "inject/lock_files.h"
#include "limb_ring/ring_directory.h"
#include "runtime/supervisor/process_state.h"

namespace limb_ring::ringctl {

using nlohmann::json;

json down_row(const NodeName& node) {
  return {{"id", node.id},
          {"name", node.name},
          {"state", "down"},
          {"pid", nullptr},
          {"cpu", {{"pid", nullptr}, {"boots", nullptr}, {"state", "unknown"}}},
          {"ring_size", nullptr},
          {"round_trip_us", {{"p50", nullptr}, {"p99", nullptr}, {"max", nullptr}}},
          {"counters", json::object()}};
}

json absent_row(const std::string& ring, const NodeName& node) {
  const inject::Holder holder = inject::holder_of(ring_directory(ring), node.id);
  json row = down_row(node);
  if (holder.held) row["pid"] = holder.pid;
  if (holder.held && runtime::is_stopped(holder.pid)) row["state"] = "frozen";
  return row;
}

std::vector<json> status_rows(const RingAccess& ring) {
  const auto answers = ask_all(ring.ring(), ring.nodes(), {{"do", "status"}});
  std::vector<json> rows;
  for (std::size_t i = 0; i < answers.size(); ++i)
    rows.push_back(answers[i] ? *answers[i] : absent_row(ring.ring(), ring.nodes()[i]));
  add_verdicts(rows);
  return rows;
}

bool is_up(const json& row) {
  const std::string state = row.value("state", "");
  return state == "up" || state == "folded";
}

std::string cpu_word(const json& row) {
  const json cpu = row.value("cpu", json::object());
  if (cpu.value("verdict", "") == "hung") return "hung";
  return cpu.value("stopped", false) ? "stopped" : cpu.value("state", "unknown");
}

std::uint64_t errors_of(const json& row) {
  const json counters = row.value("counters", json::object());
  std::uint64_t all = 0;
  for (const char* name : {"crc_errors", "malformed_packets", "oversize_packets", "stalled_packets",
                           "broken_off_packets", "insertion_buffer_full", "interrupt_buffer_full",
                           "dropped_no_output", "returns_damaged", "timeouts", "ended_lost"})
    all += counters.value(name, std::uint64_t{0});
  return all;
}

std::string headline(const std::string& ring, const std::vector<json>& rows) {
  std::size_t up = 0, folded = 0, part = rows.size();
  for (const json& row : rows) {
    if (row.value("state", "") == "folded") {
      ++folded;
      part = std::min(part, row.value("ring_size", rows.size()));
    }
    up += is_up(row) ? 1 : 0;
  }
  const char* fold = folded == 0 ? "" : part < up ? ", folded back in parts" : ", folded back around a break";
  return "ring " + ring + ": " + std::to_string(up) + " of " + std::to_string(rows.size()) + " nodes up" + fold;
}

}  // namespace limb_ring::ringctl
