#include "app/ringctl/status_table.h"

#include "app/common/text_table.h"

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

std::string cell(const json& row, const char* pointer, int decimals = 0) {
  const json::json_pointer path(pointer);
  if (!row.contains(path)) return "-";
  const json& value = row.at(path);
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return app::number(value.get<double>(), decimals);
  if (value.is_number()) return value.get<double>() < 0 ? "-" : value.dump();
  return "-";
}

/// The supervisor's word where it says hung: the node's own network controller says silent, no more, and
/// that only of a CPU which has promised to speak.
std::string cpu_cell(const json& row) {
  const std::string verdict = cell(row, "/cpu/verdict");
  if (verdict == "hung") return verdict;
  return row["cpu"].value("stopped", false) ? "stopped" : cell(row, "/cpu/state");
}

std::vector<std::string> cells(const json& row) {
  return {cell(row, "/id"),          cell(row, "/name"),
          cell(row, "/state"),       cell(row, "/pid"),
          cell(row, "/ring_size"),   cell(row, "/round_trip_us/p50", 1),
          cell(row, "/round_trip_us/p99", 1), cell(row, "/round_trip_us/max", 1),
          cpu_cell(row),             cell(row, "/cpu/pid"),
          cell(row, "/cpu/boots")};
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

std::string status_table(const std::vector<json>& rows) {
  std::vector<std::vector<std::string>> table{{"id", "name", "state", "pid", "ring", "p50 us",
                                               "p99 us", "max us", "cpu", "cpu pid", "boots"}};
  for (const json& row : rows) table.push_back(cells(row));
  return app::text_table(table);
}

}  // namespace limb_ring::ringctl
