#include "tools/ringctl/status_table.h"

#include <algorithm>
#include <sstream>

#include "tools/common/colour.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

constexpr std::size_t kLeastName = 8;

std::string whole(const json& row, const char* pointer) {
  const json value = row.value(json::json_pointer(pointer), json());
  return value.is_number() && value.get<double>() >= 0 ? value.dump() : "-";
}

std::string trip(const json& row, const char* which) {
  return us_cell(row.value(json::json_pointer(std::string("/round_trip_us/") + which), json()));
}

std::vector<std::string> cells(const json& row, bool pids) {
  std::vector<std::string> all{whole(row, "/id"),        row.value("name", ""), row.value("state", ""),
                               whole(row, "/ring_size"), cpu_word(row),         whole(row, "/cpu/boots"),
                               trip(row, "p50"),         trip(row, "p99"),      trip(row, "max")};
  if (pids) all.insert(all.end(), {whole(row, "/pid"), whole(row, "/cpu/pid")});
  if (row.contains("host")) all.push_back(row.value("host", ""));
  return all;
}

std::size_t widest_line(const std::string& table) {
  std::size_t widest = 0;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) widest = std::max(widest, line.size());
  return widest;
}

/// If the table is too wide, the names are shortened.
std::string fitted(std::vector<std::vector<std::string>> table, std::size_t width) {
  const std::string whole_table = app::text_table(table);
  const std::size_t widest = widest_line(whole_table);
  if (widest <= width) return whole_table;
  std::size_t name = 0;
  for (const auto& row : table) name = std::max(name, row[1].size());
  const std::size_t over = widest - width;
  const std::size_t room = std::max(kLeastName, name > over ? name - over : 0);
  for (auto& row : table) row[1] = app::shortened(row[1], room);
  return app::text_table(table);
}

}  // namespace

std::string us_cell(const json& value) {
  if (!value.is_number()) return "-";
  const double us = value.get<double>();
  return app::number(us, us < 999.95 ? 1 : 0);
}

const char* status_colour(const std::string& state, const std::string& cpu) {
  if (state != "up" && state != "folded") return app::kRed;
  for (const char* bad : {"hung", "stopped", "silent", "failed"})
    if (cpu == bad) return app::kYellow;
  return "";
}

std::string status_table(const std::vector<json>& rows, const StatusStyle& style) {
  std::vector<std::vector<std::string>> table{
      {"id", "name", "state", "ring", "cpu", "boots", "p50 us", "p99 us", "max us"}};
  if (style.pids) table[0].insert(table[0].end(), {"pid", "cpu pid"});
  if (!rows.empty() && rows.front().contains("host")) table[0].push_back("host");
  for (const json& row : rows) table.push_back(cells(row, style.pids));
  const std::string text = fitted(std::move(table), style.width);
  if (!style.colour) return text;
  std::istringstream lines(text);
  std::string out, line;
  for (std::size_t i = 0; std::getline(lines, line); ++i) {
    const std::string colour =
        i == 0 ? app::kDim : status_colour(rows[i - 1].value("state", ""), cpu_word(rows[i - 1]));
    out += colour + line + (colour.empty() ? "" : app::kPlain) + '\n';
  }
  return out;
}

}  // namespace limb_ring::ringctl
