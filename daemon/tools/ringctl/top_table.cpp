#include "tools/ringctl/top_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <thread>
#include <utility>

#include "ring/reset_node.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {

using nlohmann::json;
using status::NodeRow;

namespace {

std::uint64_t packets_out(const NodeRow& row) {
  return row.counter("relayed_data") + row.counter("relayed_interrupts") + row.counter("sent_data") +
         row.counter("sent_interrupts");
}

std::uint64_t bytes_in(const NodeRow& row) {
  return ask::line_bytes_in([&row](const char* name) { return row.counter(name); });
}

/// Both rows are of the same boot, so the counters have not restarted at 0 in between.
bool comparable(const NodeRow& before, const NodeRow& now) { return now.pid && before.pid == now.pid; }

/// By the node's own clock, which on a virtual ring is not the machine's.
double elapsed(const StatusSample& before, const StatusSample& now, std::size_t index) {
  const auto then = before.rows[index].uptime_s, at_present = now.rows[index].uptime_s;
  return then && at_present ? *at_present - *then : now.at_s - before.at_s;
}

/// Growth of a figure per second; nothing if it is not known.
template <typename Figure>
std::optional<double> rate(const StatusSample& before, const StatusSample& now, std::size_t index, Figure figure) {
  if (index >= now.rows.size() || !comparable(before.rows[index], now.rows[index])) return std::nullopt;
  const double seconds = elapsed(before, now, index);
  const std::uint64_t then = figure(before.rows[index]), at_present = figure(now.rows[index]);
  if (seconds <= 0 || at_present < then) return std::nullopt;
  return static_cast<double>(at_present - then) / seconds;
}

std::size_t index_of(const StatusSample& sample, std::optional<std::uint8_t> id) {
  const auto found =
      std::find_if(sample.rows.begin(), sample.rows.end(), [&id](const NodeRow& row) { return row.id == id; });
  return static_cast<std::size_t>(found - sample.rows.begin());
}

json or_null(const std::optional<double>& value) { return value ? json(*value) : json(); }

json load_of(const NodeRow& row, const std::optional<double>& bytes) {
  if (!bytes || !row.output || !row.output->rate_bit_s) return json();
  return 8 * *bytes / static_cast<double>(*row.output->rate_bit_s);
}

json changed(const StatusSample& before, const NodeRow& row, std::size_t index) {
  json names = json::array();
  if (index >= before.rows.size()) return names;
  const NodeRow& then = before.rows[index];
  if (then.state != row.state) names.push_back("state");
  if (cpu_word(then) != cpu_word(row)) names.push_back("cpu");
  if (comparable(then, row) && errors_of(then) != errors_of(row)) names.push_back("errors");
  return names;
}

json top_row(const StatusSample& before, const StatusSample& now, std::size_t index) {
  const NodeRow& row = now.rows[index];
  const auto to = row.output ? row.output->to : std::nullopt;
  const auto bytes = rate(before, now, index_of(now, to), bytes_in);
  return {{"id", row.id},
          {"name", row.name},
          {"state", row.state},
          {"to", to ? json(*to) : json()},
          {"packets_per_second", or_null(rate(before, now, index, packets_out))},
          {"bytes_per_second", or_null(bytes)},
          {"load", load_of(row, bytes)},
          {"round_trip_us", to_json(row.round_trip_us)},
          {"errors", errors_of(row)},
          {"cpu", cpu_word(row)},
          {"changed", changed(before, row, index)}};
}

std::string number(const json& value, double unit = 1) {
  char text[32];
  if (!value.is_number()) return "-";
  const double shown = value.get<double>() / unit;
  std::snprintf(text, sizeof text, "%.*f", shown < 9.95 ? 1 : 0, shown);
  return text;
}

std::string percent(const json& share) { return share.is_number() ? number(share, 0.01) + "%" : "-"; }

constexpr std::size_t kColumns = 10;
constexpr std::size_t kNarrow = 80;

/// Of the columns behind the name; negative: aligned to the left.
constexpr std::array<int, kColumns> kWidths{-14, -10, -7, 4, 7, 7, 4, 6, 6, 5};
using Cells = std::array<std::string, kColumns>;

/// @param name columns of the name
std::string padded(const std::string& text, std::size_t column, std::size_t name) {
  const int width = column == 0 ? -static_cast<int>(name) : kWidths[column];
  const std::string cell = app::shortened(text, static_cast<std::size_t>(std::abs(width)));
  const std::string blanks(static_cast<std::size_t>(std::abs(width)) - cell.size(), ' ');
  return width < 0 ? cell + blanks : blanks + cell;
}

std::string columns(const Cells& cells, std::size_t name, const std::array<const char*, kColumns>& colours) {
  std::string line;
  for (std::size_t i = 0; i < kColumns; ++i) {
    const std::string cell = padded(cells[i], i, name);
    const bool plain = colours[i] == nullptr || *colours[i] == '\0';
    line += (i == 0 ? "" : " ") + (plain ? cell : colours[i] + cell + app::kPlain);
  }
  return line.erase(line.find_last_not_of(' ') + 1) + '\n';
}

bool has_changed(const json& row, const char* what) {
  const json& names = row["changed"];
  return std::find(names.begin(), names.end(), what) != names.end();
}

std::array<const char*, kColumns> colours_of(const json& row) {
  std::array<const char*, kColumns> colours{};
  colours[0] = status_colour(row["state"].get<std::string>(), row["cpu"].get<std::string>());
  if (has_changed(row, "state")) colours[1] = app::kChanged;
  if (has_changed(row, "cpu")) colours[2] = app::kChanged;
  if (has_changed(row, "errors")) colours[9] = app::kChanged;
  return colours;
}

Cells cells_of(const json& row) {
  const json& trip = row["round_trip_us"];
  return {row["name"].get<std::string>(),
          row["state"].get<std::string>(),
          row["cpu"].get<std::string>(),
          row["to"].is_number() ? row["to"].dump() : "-",
          number(row["packets_per_second"]),
          number(row["bytes_per_second"], 1000),
          percent(row["load"]),
          number(trip.value("p50", json())),
          number(trip.value("p99", json())),
          row["errors"].dump()};
}

/// Columns for the names: as many as they need, as long as all else fits too.
std::size_t name_width(const std::vector<json>& rows, std::size_t columns) {
  std::size_t longest = 4;
  for (const json& row : rows) longest = std::max(longest, row["name"].get<std::string>().size());
  return std::min(longest, static_cast<std::size_t>(-kWidths[0]) + columns - kNarrow);
}

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

std::vector<json> top_rows(const StatusSample& before, const StatusSample& now) {
  std::vector<json> rows;
  for (std::size_t i = 0; i < now.rows.size(); ++i) rows.push_back(top_row(before, now, i));
  return rows;
}

std::string top_table(const std::string& heading, const std::vector<json>& rows, const TopStyle& style,
                      const std::string& report) {
  const std::size_t width = std::max(style.width, kNarrow), name = name_width(rows, width);
  std::string text = app::wrapped(heading + "; rates of the line out of each", width);
  text += columns({"name", "state", "cpu", "to", "pkt/s", "kB/s", "load", "p50 us", "p99 us", "errs"}, name, {});
  const std::string below = app::wrapped(report, width);
  const std::size_t headings = lines_of(text);
  const std::size_t room = style.lines > headings + 2 ? style.lines - headings - 1 : 1;  // with a line to spare
  const std::size_t shown = rows.size() <= room + 1 ? rows.size() : room;
  for (std::size_t i = 0; i < shown; ++i)
    text += columns(cells_of(rows[i]), name, style.colour ? colours_of(rows[i]) : decltype(colours_of(rows[i])){});
  if (shown < rows.size()) text += "... and " + std::to_string(rows.size() - shown) + " more nodes\n";
  std::istringstream more(below);
  for (std::string line; lines_of(text) < style.lines && std::getline(more, line);) text += line + '\n';
  return text;
}

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

/// How long daemons that do not answer may delay the next picture: in all, and for each if that is more.
constexpr milliseconds kAnswerWait{500}, kAnswerWaitEach{10};
/// Messages taken from one node before the next node has its turn.
constexpr int kMessagesAtOnce = 1000;
constexpr milliseconds kTurn{50};

}  // namespace

StatusPoll::StatusPoll(const RingAccess& ring, Order order, Seen seen)
    : ring_(ring), order_(std::move(order)), client_(ring.ring(), ring.nodes(), Stay::for_long) {
  if (seen) client_.on_message = std::move(seen);
  if (order_) client_.on_connect = [this](std::size_t node, HostPort& port) { port.observe(order_(node)); };
}

std::vector<ask::ToldRow> StatusPoll::round(bool with_heard) {
  const auto patience = std::max(kAnswerWait, kAnswerWaitEach * static_cast<int>(ring_.nodes().size()));
  return client_.status(steady_clock::now() + patience, with_heard);
}

StatusSample StatusPoll::sample() {
  StatusSample sample;
  sample.at_s = std::chrono::duration<double>(steady_clock::now().time_since_epoch()).count();
  std::vector<ask::ToldRow> told = round(wants_heard_);
  const bool absent = std::any_of(told.begin(), told.end(), [](const ask::ToldRow& one) { return !one.said; });
  if (absent && !wants_heard_) told = round(true);
  wants_heard_ = absent;
  sample.rows = complete_rows(ring_, told);
  sample.clock = ring_clock(ring_.ring());
  return sample;
}

void StatusPoll::observe(std::size_t node) {
  HostPort* port = client_.port(node);
  if (order_ && port != nullptr) port->observe(order_(node));
}

void StatusPoll::drain(std::size_t index) {
  HostPort* port = client_.port(index);
  for (int i = 0; i < kMessagesAtOnce && port != nullptr && port->connected(); ++i) {
    const auto message = port->receive(milliseconds(0));
    if (!message) return;
    client_.on_message(index, *message);
  }
}

// In turns, not as each message comes: of many packets a second, each would wake this process.
void StatusPoll::listen(steady_clock::time_point until) {
  for (;;) {
    for (std::size_t i = 0; i < ring_.nodes().size(); ++i) drain(i);
    const auto now = steady_clock::now();
    if (now >= until) return;
    std::this_thread::sleep_until(std::min(until, now + kTurn));
  }
}

}  // namespace limb_ring::ringctl
