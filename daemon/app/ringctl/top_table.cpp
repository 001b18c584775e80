#include "app/ringctl/top_table.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

constexpr unsigned kSliceHeader = 4;  // the framing of the link: no bytes of the ring

std::uint64_t counter(const json& row, const char* name) {
  return row.contains("counters") ? row["counters"].value(name, std::uint64_t{0}) : 0;
}

std::uint64_t sum(const json& row, std::initializer_list<const char*> names) {
  std::uint64_t all = 0;
  for (const char* name : names) all += counter(row, name);
  return all;
}

std::uint64_t packets_out(const json& row) {
  return sum(row, {"relayed_data", "relayed_interrupts", "sent_data", "sent_interrupts"});
}

std::uint64_t bytes_in(const json& row) {
  const std::uint64_t all = counter(row, "input_bytes");
  return all - std::min(all, kSliceHeader * sum(row, {"input_slices", "input_idle_slices"}));
}

std::uint64_t errors(const json& row) {
  return sum(row, {"crc_errors", "malformed_packets", "oversize_packets", "stalled_packets", "broken_off_packets",
                   "insertion_buffer_full", "interrupt_buffer_full", "dropped_no_output", "returns_damaged", "timeouts",
                   "ended_lost"});
}

/// Of the same life, so that the counters have not begun anew.
bool comparable(const json& before, const json& now) {
  return now.contains("pid") && now["pid"].is_number() && before.value("pid", json()) == now["pid"];
}

/// Growth of a figure in a second; nothing where it cannot be known.
template <typename Figure>
std::optional<double> rate(const StatusSample& before, const StatusSample& now, std::size_t index, Figure figure) {
  if (index >= now.rows.size() || !comparable(before.rows[index], now.rows[index])) return std::nullopt;
  const double seconds = now.at_s - before.at_s;
  const std::uint64_t then = figure(before.rows[index]), at_present = figure(now.rows[index]);
  if (seconds <= 0 || at_present < then) return std::nullopt;
  return static_cast<double>(at_present - then) / seconds;
}

std::size_t index_of(const StatusSample& sample, const json& id) {
  const auto found = std::find_if(sample.rows.begin(), sample.rows.end(),
                                  [&id](const json& row) { return row.value("id", json()) == id; });
  return static_cast<std::size_t>(found - sample.rows.begin());
}

json or_null(const std::optional<double>& value) { return value ? json(*value) : json(); }

json load_of(const json& row, const std::optional<double>& bytes) {
  const json bits = row.value(json::json_pointer("/output/rate_bit_s"), json());
  if (!bytes || !bits.is_number()) return json();
  return 8 * *bytes / bits.get<double>();
}

json top_row(const StatusSample& before, const StatusSample& now, std::size_t index) {
  const json& row = now.rows[index];
  const json to = row.value(json::json_pointer("/output/to"), json());
  const auto bytes = rate(before, now, index_of(now, to), bytes_in);
  return {{"id", row.value("id", 0)},
          {"name", row.value("name", "")},
          {"state", row.value("state", "")},
          {"to", to},
          {"packets_per_second", or_null(rate(before, now, index, packets_out))},
          {"bytes_per_second", or_null(bytes)},
          {"load", load_of(row, bytes)},
          {"round_trip_us", row.value("round_trip_us", json::object())},
          {"errors", errors(row)},
          {"cpu", row.value(json::json_pointer("/cpu/state"), "")}};
}

std::string number(const json& value, double unit = 1) {
  char text[32];
  if (!value.is_number()) return "-";
  const double shown = value.get<double>() / unit;
  std::snprintf(text, sizeof text, "%.*f", shown < 9.95 ? 1 : 0, shown);
  return text;
}

std::string percent(const json& share) { return share.is_number() ? number(share, 0.01) + "%" : "-"; }

std::string cut(const std::string& text, std::size_t width) {
  return text.size() <= width ? text : text.substr(0, width - 1) + "~";
}

std::string columns(const std::array<std::string, 10>& cells) {
  constexpr int kWidths[] = {-14, -10, 4, 7, 7, 4, 6, 6, 5, -7};  // negative: aligned to the left
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string cell = cut(cells[i], static_cast<std::size_t>(std::abs(kWidths[i])));
    char text[32];
    std::snprintf(text, sizeof text, "%s%*s", i == 0 ? "" : " ", kWidths[i], cell.c_str());
    line += text;
  }
  return line + '\n';
}

std::string line_of(const json& row) {
  const json& trip = row["round_trip_us"];
  return columns({row["name"].get<std::string>(), row["state"].get<std::string>(),
                  row["to"].is_number() ? row["to"].dump() : "-", number(row["packets_per_second"]),
                  number(row["bytes_per_second"], 1000), percent(row["load"]), number(trip.value("p50", json())),
                  number(trip.value("p99", json())), row["errors"].dump(), row["cpu"].get<std::string>()});
}

}  // namespace

std::vector<json> top_rows(const StatusSample& before, const StatusSample& now) {
  std::vector<json> rows;
  for (std::size_t i = 0; i < now.rows.size(); ++i) rows.push_back(top_row(before, now, i));
  return rows;
}

std::string top_table(const std::string& ring, const std::vector<json>& rows, std::size_t lines) {
  const auto up = std::count_if(rows.begin(), rows.end(), [](const json& row) { return row["state"] == "up"; });
  std::string text = "ring " + ring + ": " + std::to_string(up) + " of " + std::to_string(rows.size()) +
                     " nodes up; rates of the line out of each node\n";
  text += columns({"node", "state", "to", "pkt/s", "kB/s", "load", "p50 us", "p99 us", "errs", "cpu"});
  const std::size_t room = lines > 3 ? lines - 3 : 1;
  const std::size_t shown = rows.size() <= room + 1 ? rows.size() : room;
  for (std::size_t i = 0; i < shown; ++i) text += line_of(rows[i]);
  if (shown < rows.size()) text += "... and " + std::to_string(rows.size() - shown) + " more nodes\n";
  return text;
}

}  // namespace limb_ring::ringctl
