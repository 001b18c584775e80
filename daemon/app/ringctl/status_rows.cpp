#include "app/ringctl/status_rows.h"

#include <algorithm>

#include "app/ringctl/answers.h"
#include "app/ringctl/supervision.h"
#include "inject/lock_files.h"
#include "limb_ring/ring_directory.h"
#include "process/process_state.h"

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

bool latched(const json& row) {
  const json::json_pointer place("/cpu/stop/latched");
  return row.contains(place) && row.at(place) == true;
}

std::string name_of(const std::vector<json>& rows, const json& id) {
  for (const json& row : rows)
    if (row.value("id", json()) == id) return row.value("name", id.dump());
  return id.dump();
}

/// ": line A -> B broken"; every node in the chain knows it.
std::string broken_line(const std::vector<json>& rows) {
  for (const json& row : rows) {
    const json line = row.value("broken_line", json());
    if (line.is_object())
      return ": line " + name_of(rows, line.at("before")) + " -> " + name_of(rows, line.at("behind")) + " broken";
  }
  return "";
}

}  // namespace

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
  if (holder.held && process::is_stopped(holder.pid)) row["state"] = "frozen";
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
  if (cpu.value("stopped", false)) return "stopped";
  return latched(row) ? "stop" : cpu.value("state", "unknown");
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
  std::size_t up = 0, folded = 0, open = 0, part = rows.size();
  for (const json& row : rows) {
    open += row.value("state", "") == "open_chain" ? 1 : 0;
    if (row.value("state", "") == "folded") {
      ++folded;
      part = std::min(part, row.value("ring_size", rows.size()));
    }
    up += is_up(row) ? 1 : 0;
  }
  const char* fold = folded == 0 ? "" : part < up ? ", folded back in parts" : ", folded back around a break";
  const std::string working = std::to_string(up + open) + " of " + std::to_string(rows.size()) + " nodes ";
  return "ring " + ring + ": " + working + (open != 0 ? "work, open chain" + broken_line(rows) : "up" + std::string(fold));
}

std::string stop_report(const std::vector<json>& rows) {
  std::string names;
  std::size_t count = 0;
  for (const json& row : rows) {
    if (!latched(row)) continue;
    ++count;
    names += (names.empty() ? "" : ", ") + row.value("name", "");
  }
  if (count == 0) return "";
  return "stop latched at " + (count == rows.size() ? "all nodes" : names) + "; 'ringctl resume' ends it\n";
}

}  // namespace limb_ring::ringctl
