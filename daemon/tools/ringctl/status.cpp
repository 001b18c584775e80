#include "tools/ringctl/status.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <sstream>
#include <utility>

#include "io/signal_wait.h"
#include "limb_ring/ring_directory.h"
#include "tools/common/command_line.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/line_report.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/ring_folder.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/status_poll.h"
#include "tools/ringctl/status_rows.h"
#include "tools/ringctl/top_table.h"

namespace limb_ring::ringctl {
namespace {

using std::chrono::duration;
using std::chrono::steady_clock;

struct StatusOptions {
  std::string ring;
  double interval_s = 1;
  bool json = false, all = false, pids = false, watch = false, once = false;
};

void drop_zeros(nlohmann::json& counters) {
  for (auto it = counters.begin(); it != counters.end();) it = it.value() == 0 ? counters.erase(it) : std::next(it);
}

void print_json(const RingAccess& ring, std::vector<nlohmann::json> rows, bool all_counters) {
  for (auto& row : rows) {
    row.erase("ring");  // once is enough
    row["cpu"]["state"] = cpu_word(row);
    if (!all_counters) drop_zeros(row["counters"]);
  }
  nlohmann::json all{{"ring", ring.ring()}, {"path", ring.path()}, {"nodes", rows}};
  const nlohmann::json clock = ring_clock(ring.ring());
  if (clock.is_object()) all["clock"] = clock;
  std::cout << all.dump(2) << '\n';
}

void print_text(const RingAccess& ring, const std::vector<nlohmann::json>& rows, bool pids) {
  StatusStyle style;
  style.pids = pids;
  style.colour = app::colour_wanted(STDOUT_FILENO);
  // What goes into a file or through a pipe is for grep: as wide as it is.
  if (::isatty(STDOUT_FILENO) == 1) style.width = Screen::size().columns;
  const std::string heading = headline(ring.ring(), rows) + clock_words(ring_clock(ring.ring()));
  std::cout << app::wrapped(heading, style.width) << status_table(rows, style)
            << app::wrapped(round_trips_since(rows) + line_report(rows) + unanswered_report(rows) + down_report(rows) +
                                cpu_report(rows) + warning_report(rows) + stop_report(rows) + supervision_text(rows),
                            style.width);
}

/// Of a ring that is frozen as a whole, the nodes that its files tell of.
RingAccess running_or_frozen(const std::string& ring) {
  try {
    return RingAccess::open(ring);
  } catch (const AllFrozen&) {
    return RingAccess::open_also_dead(ring);
  }
}

int show_once(const Context& context, const StatusOptions& options) {
  const RingAccess ring = running_or_frozen(choose_ring(options.ring, context.ring));
  tell_unreadable(ring_directory(ring.ring()));
  const auto rows = status_rows(ring);
  if (options.json)
    print_json(ring, rows, options.all);
  else
    print_text(ring, rows, options.pids);
  return kDone;
}

/// @return false where somebody has asked it to end
bool wait(const StatusOptions& options, Screen* screen, process::SignalWait& signals) {
  const auto until = steady_clock::now() + duration<double>(options.interval_s);
  while (steady_clock::now() < until) {
    if (process::SignalWait::asks_to_end(signals.next(process::SignalWait::kTick))) return false;
    if (screen == nullptr) continue;
    const char key = screen->key();
    if (key == 'q' || key == 'Q') return false;
    if (key != Screen::kCtrlZ) continue;
    screen->stop_and_go_on();
    return true;
  }
  return true;
}

TopStyle style() {
  TopStyle style;
  style.colour = app::colour_wanted(STDOUT_FILENO);
  if (::isatty(STDOUT_FILENO) == 1) style.width = Screen::size().columns;
  return style;
}

std::string shown(const RingAccess& ring, const StatusSample& now, const std::vector<nlohmann::json>& rows,
                  const TopStyle& style) {
  return top_table(headline(ring.ring(), now.rows) + clock_words(now.clock), rows, style,
                   round_trips_since(now.rows) + line_report(now.rows) + unanswered_report(now.rows) +
                       down_report(now.rows) + cpu_report(now.rows) + warning_report(now.rows) + stop_report(now.rows) +
                       supervision_text(now.rows));
}

nlohmann::json json_of(const RingAccess& ring, const StatusSample& now, const std::vector<nlohmann::json>& rows) {
  nlohmann::json all{{"ring", ring.ring()}, {"nodes", rows}};
  if (now.clock.is_object()) all["clock"] = now.clock;
  return all;
}

int rates_once(const RingAccess& ring, const StatusOptions& options) {
  process::SignalWait signals;
  StatusPoll poll(ring);
  const StatusSample before = poll.sample();
  if (!wait(options, nullptr, signals)) return kNotDone;
  const StatusSample now = poll.sample();
  const auto rows = top_rows(before, now);
  if (options.json)
    std::cout << json_of(ring, now, rows).dump(2) << '\n';
  else
    std::cout << shown(ring, now, rows, style());
  return kDone;
}

int redraw(const RingAccess& ring, const StatusOptions& options) {
  process::SignalWait signals;
  Screen screen;
  StatusPoll poll(ring);
  StatusSample now = poll.sample(), before = now;  // no time between them: the first picture has no rates
  for (;;) {
    TopStyle fits = style();
    fits.lines = Screen::size().lines - 1;
    screen.draw(shown(ring, now, top_rows(before, now), fits) + "q ends");
    if (!wait(options, &screen, signals)) return kDone;
    before = std::exchange(now, poll.sample());
  }
}

int watch(const Context& context, const StatusOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(options.ring, context.ring));
  return options.once ? rates_once(ring, options) : redraw(ring, options);
}

int run(const Context& context, const StatusOptions& options) {
  if (options.watch && options.json && !options.once) throw UsageError("--watch --json goes with --once");
  return options.watch ? watch(context, options) : show_once(context, options);
}

}  // namespace

void add_status(CLI::App& app, Context& context) {
  auto options = std::make_shared<StatusOptions>();
  CLI::App* command =
      add_command(app, "status", "Show all nodes, once or again and again (--watch)", "ringctl status leg8 --watch",
                  "A node without a daemon is 'down'. If its daemon is stopped by a signal, it is 'frozen'. If its "
                  "daemon lives and does not answer, it is 'unanswered'.");
  command->add_option("RING", options->ring, "Name of the ring; default: as --ring");
  CLI::Option* watch =
      command->add_flag("-w,--watch", options->watch, "Draw it again and again, with rates, load and errors; q ends");
  command->add_option("-i,--interval", options->interval_s, "Seconds between two readings, 0.1 to 3600; default 1")
      ->transform(cli::seconds(0.1, 3600.0))
      ->needs(watch);
  command->add_flag("--once", options->once, "Print the rates of one interval, and end")->needs(watch);
  command->add_flag("-p,--pids", options->pids, "Process numbers of daemons and CPUs too")->excludes(watch);
  add_json(*command, options->json);
  command->add_flag("-a,--all", options->all, "With --json: counters that are zero, too")->excludes(watch);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

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
