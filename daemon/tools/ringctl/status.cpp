#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "io/signal_wait.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/common/command_line.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/ring_folder.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/status_rows.h"
#include "tools/ringctl/top_table.h"

namespace limb_ring::ringctl {
namespace {

using status::NodeRow;
using std::chrono::duration;
using std::chrono::steady_clock;

std::string figure(const nlohmann::json& clock, const char* name) {
  return clock.is_object() ? app::number(clock[name].get<double>(), 3) : "-";
}

/// {"host": this one, "hosts": all names} of a ring that has hosts; else, and if no daemon answers, empty.
nlohmann::json hosts_of(const std::string& ring) {
  try {
    const RingAccess access = RingAccess::open(ring);
    if (access.hosts().empty()) return nlohmann::json::object();
    nlohmann::json names = nlohmann::json::array();
    for (const RingHost& host : access.hosts()) names.push_back(host.name);
    return {{"host", access.here()}, {"hosts", names}};
  } catch (const std::exception&) {
    return nlohmann::json::object();
  }
}

/// "waist (of waist, head)"
std::string words_of(const nlohmann::json& hosts) {
  if (hosts.empty()) return "-";
  std::string all;
  for (const auto& name : hosts["hosts"]) all += (all.empty() ? "" : ", ") + name.get<std::string>();
  return hosts["host"].get<std::string>() + " (of " + all + ")";
}

/// `ringctl status --rings`: prints a table, or JSON, of all rings of this user. @return an ExitCode
int show_rings(bool as_json) {
  tell_unreadable_rings();
  for (const std::string& folder : live::ring_folders()) tell_unreadable(folder);
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  std::vector<std::vector<std::string>> rows{{"ring", "nodes", "host", "clock", "at s", "pace", "late s", "lost s"}};
  for (const std::string& ring : live::held_rings()) {
    const std::string folder = ring_directory(ring);
    const std::vector<live::HeldNode> nodes = live::held_nodes(folder);
    if (nodes.empty()) continue;  // it ended meanwhile
    const auto count = std::count_if(nodes.begin(), nodes.end(),
                                     [&](const auto& node) { return live::holder_of(folder, node.node).held; });
    const char* kind = live::holder_of(folder, nodes.front().node).on_virtual_ring ? "virtual" : "live";
    const nlohmann::json clock = ring_clock(ring);
    const nlohmann::json hosts = hosts_of(ring);
    rows.push_back({ring, std::to_string(count), words_of(hosts), kind, figure(clock, "now_s"),
                    clock.is_object() ? pace_text(clock["pace"]) : "-", figure(clock, "late_s"),
                    figure(clock, "lost_s")});
    all.push_back({{"ring", ring}, {"nodes", count}, {"clock", kind}});
    if (!hosts.empty()) all.back().update(hosts);
    for (const auto& entry : clock.items()) all.back()[entry.key()] = entry.value();
  }
  if (as_json)
    std::cout << all.dump(2) << std::endl;
  else
    std::cout << (all.empty() ? "no ring is running\n" : app::text_table(rows)) << std::flush;
  return kDone;
}

struct StatusOptions {
  std::string ring;
  double interval_s = 1;
  bool json = false, all = false, pids = false, watch = false, once = false, fields = false, rings = false;
};

void drop_zeros(std::map<std::string, std::uint64_t>& counters) {
  for (auto it = counters.begin(); it != counters.end();) it = it->second == 0 ? counters.erase(it) : std::next(it);
}

void print_json(const RingAccess& ring, Rows rows, bool all_counters) {
  nlohmann::json nodes = nlohmann::json::array();
  for (NodeRow& row : rows) {
    row.ring.clear();  // once is enough
    row.cpu.state = cpu_word(row);
    if (!all_counters) drop_zeros(row.counters);
    nodes.push_back(to_json(row));
  }
  nlohmann::json all{{"ring", ring.ring()}, {"path", ring.path()}, {"nodes", nodes}};
  const nlohmann::json clock = ring_clock(ring.ring());
  if (clock.is_object()) all["clock"] = clock;
  std::cout << all.dump(2) << '\n';
}

void print_text(const RingAccess& ring, const Rows& rows, bool pids) {
  StatusStyle style;
  style.pids = pids;
  style.colour = app::colour_wanted(STDOUT_FILENO);
  // What goes into a file or through a pipe is for grep: as wide as it is.
  if (::isatty(STDOUT_FILENO) == 1) style.width = Screen::size().columns;
  const std::string heading = headline(ring.ring(), rows) + clock_words(ring_clock(ring.ring()));
  std::cout << app::wrapped(heading, style.width) << status_table(rows, style)
            << app::wrapped(round_trips_since(rows) + whole_report(rows), style.width);
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

/// @return false if somebody has asked it to end
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
                   round_trips_since(now.rows) + whole_report(now.rows));
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
  if (options.fields) {
    std::cout << status::members_of_row();
    return kDone;
  }
  if (options.rings) {
    require_no_ring(context, "--rings shows all rings");
    return show_rings(options.json);
  }
  if (options.watch && options.json && !options.once) throw UsageError("--watch --json goes with --once");
  return options.watch ? watch(context, options) : show_once(context, options);
}

}  // namespace

void add_status(CLI::App& app, Context& context) {
  auto options = std::make_shared<StatusOptions>();
  CLI::App* command = add_command(
      app, "status", "Show all nodes of a ring, or all rings (--rings)", "ringctl status leg8 --watch",
      "A node without a daemon is 'down'. If its daemon is stopped by a signal, it is 'frozen'. If its "
      "daemon lives and does not answer, it is 'unanswered'.\n"
      "--rings prints for each ring: nodes, how many of them run on this machine; host, which of the ring's "
      "hosts this machine is; clock, live or virtual; of a virtual ring also its time, its pace, and how far "
      "it is behind.");
  command->add_option("RING", options->ring, "Name of the ring; default: as --ring");
  CLI::Option* watch =
      command->add_flag("-w,--watch", options->watch, "Draw it again and again, with rates, load and errors; q ends");
  command->add_option("-i,--interval", options->interval_s, "Seconds between two readings, 0.1 to 3600; default 1")
      ->transform(cli::seconds(0.1, 3600.0))
      ->needs(watch);
  command->add_flag("--once", options->once, "Print the rates of one interval, and end")->needs(watch);
  command->add_flag("-p,--pids", options->pids, "Process numbers of daemons and CPUs too")->excludes(watch);
  CLI::Option* rings = command->add_flag("--rings", options->rings, "Show all rings of this user instead of one");
  for (const char* other : {"RING", "--watch", "--pids"}) rings->excludes(command->get_option(other));
  add_json(*command, options->json);
  command->add_flag("--fields", options->fields, "What the members of --json mean, as a table, and end");
  command->add_flag("-a,--all", options->all, "With --json: counters that are zero, too")->excludes(watch);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

namespace {

constexpr std::size_t kLeastName = 8;

template <class Number>
std::string whole(const std::optional<Number>& number) {
  return number ? std::to_string(*number) : "-";
}

std::vector<std::string> cells(const NodeRow& row, bool pids) {
  const status::RoundTrips& trip = row.round_trip_us;
  std::vector<std::string> all{std::to_string(row.id), row.name,          row.state,
                               whole(row.ring_size),   cpu_word(row),     whole(row.cpu.boots),
                               us_cell(trip.p50),      us_cell(trip.p99), us_cell(trip.max)};
  if (pids) all.insert(all.end(), {whole(row.pid), whole(row.cpu.pid)});
  if (!row.host.empty()) all.push_back(row.host);
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

std::string us_cell(std::optional<double> us) { return us ? app::number(*us, *us < 999.95 ? 1 : 0) : "-"; }

const char* status_colour(const std::string& state, const std::string& cpu) {
  if (state != "up" && state != "folded") return app::kRed;
  for (const char* bad : {"hung", "stopped", "silent", "failed"})
    if (cpu == bad) return app::kYellow;
  return "";
}

std::string status_table(const Rows& rows, const StatusStyle& style) {
  std::vector<std::vector<std::string>> table{
      {"id", "name", "state", "ring", "cpu", "boots", "p50 us", "p99 us", "max us"}};
  if (style.pids) table[0].insert(table[0].end(), {"pid", "cpu pid"});
  if (!rows.empty() && !rows.front().host.empty()) table[0].push_back("host");
  for (const NodeRow& row : rows) table.push_back(cells(row, style.pids));
  const std::string text = fitted(std::move(table), style.width);
  if (!style.colour) return text;
  std::istringstream lines(text);
  std::string out, line;
  for (std::size_t i = 0; std::getline(lines, line); ++i) {
    const std::string colour = i == 0 ? app::kDim : status_colour(rows[i - 1].state, cpu_word(rows[i - 1]));
    out += colour + line + (colour.empty() ? "" : app::kPlain) + '\n';
  }
  return out;
}

}  // namespace limb_ring::ringctl
