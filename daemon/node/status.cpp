#include "node/status.h"

#include <unistd.h>

#include "io/process_state.h"
#include "node/node.h"
#include "node/realtime.h"

namespace limb_ring::runtime {
namespace {

using status::NodeRow;

/// A time in the unit of what it is assigned to.
template <class Unit>
auto count_of(core::Duration time) {
  return std::chrono::duration_cast<Unit>(time).count();
}
double seconds_of(core::Duration time) { return std::chrono::duration<double>(time).count(); }

status::Stop stop_of(const CpuSocket::Stop& stop, core::Time now) {
  status::Stop row;
  row.latched = stop.latched;
  row.latches = stop.latches;
  row.pulled = stop.pulled;
  if (stop.pulled_at) row.pulled_ms = count_of<std::chrono::milliseconds>(now - *stop.pulled_at);
  return row;
}

status::Cpu cpu_of(const CpuSocket& cpu, core::Time now) {
  const CpuStatus s = cpu.status();
  status::Cpu row;
  row.kind = to_string(s.kind);
  if (s.pid > 0) row.pid = s.pid;
  row.hung = s.pid > 0 && process::is_stopped(s.pid);
  row.boots = s.boots;
  row.state = to_string(s.state);
  row.silent_ms = s.silent.count();
  row.alive_period_ms = s.alive_period.count();
  row.restarted_by_owner = s.restarted_by_owner;
  row.resets = s.resets;
  row.last_reset = s.last_reset_reason;
  row.exits = s.exits;
  row.failed_boots = s.failed_boots;
  row.stop = stop_of(cpu.stop_state(), now);
  row.last_exit = s.last_exit;
  return row;
}

status::Input input_of(const LineEnds& ends) { return {ends.from ? "up" : "down", ends.from}; }

status::Output output_of(const LineEnds& ends, const core::Settings& settings) {
  status::Output row{ends.to ? "up" : "down", ends.to, {}};
  const std::int64_t byte_time = core::picoseconds(settings.byte_time_out);  // 0: as fast as the host
  if (byte_time != 0) row.rate_bit_s = 8 * core::Duration::period::den / byte_time;
  return row;
}

using Counters = std::map<std::string, std::uint64_t>;

/// Puts each counter under its name behind `prefix`.
auto into(Counters& all, const char* prefix) {
  return
      [&all, prefix](const char* name, const char*, std::uint64_t value) { all[std::string(prefix) + name] = value; };
}

/// What faults on purpose did is added to the counts of the first line; the links' counters have names of their own.
void add_second_line(const NodeDriver& driver, Counters& all) {
  driver.breaker(core::Line::second).counters().each([&](const char* name, const char*, std::uint64_t value) {
    all[name] += value;
  });
  driver.input_counters(core::Line::second).each(into(all, "second_input_"));
  driver.output_counters(core::Line::second).each(into(all, "second_output_"));
}

Counters counters_of(const StatusSources& from) {
  Counters all;
  from.driver.controller().counters().each(into(all, ""));
  from.driver.input_counters(core::Line::first).each(into(all, "input_"));
  from.driver.output_counters(core::Line::first).each(into(all, "output_"));
  from.driver.breaker(core::Line::first).counters().each(into(all, ""));
  if (from.driver.has_second_line()) add_second_line(from.driver, all);
  const host::HostCounters& h = from.host.counters();
  all["host_refused"] = h.refused + h.refused_foreign + h.refused_full + h.refused_unwatched;
  all["host_garbage"] = h.garbage + h.never_greeted;
  all["host_displaced"] = h.displaced;
  all["host_slow_clients"] = h.slow_clients;
  all["host_rejected"] = h.rejected;
  all["host_observed_lost"] = h.observed_lost;
  all["host_captured_lost"] = h.captured_lost;
  all["host_interrupts_lost"] = h.interrupts_lost;
  const PinCommands::Counters& commands = from.cpu.command_counters();
  all["cpu_warnings"] = from.cpu.watch().begun();
  all["pin_commands_refused"] = commands.refused;
  all["pin_commands_failed"] = commands.failed;
  all["pin_commands_timed_out"] = commands.timed_out;
  return all;
}

/// The node behind a break knows when its input fell silent; the others, when they were told.
std::optional<status::BrokenLine> broken_line_of(const StatusSources& from) {
  const auto line = from.driver.controller().membership().broken_line();
  if (!line) return std::nullopt;
  const NodeDriver& driver = from.driver;
  const bool behind = line->behind == from.node.id;
  const core::Time since = behind ? driver.input_lost_at() : driver.broken_since();
  status::BrokenLine broken{line->before, line->behind, seconds_of(driver.now() - since), {}};
  // If the node was folded already, around another break, its state does not change and broken_since() is older.
  if (behind && driver.broken_since() >= since)
    broken.announced_ms = std::chrono::duration<double, std::milli>(driver.broken_since() - since).count();
  return broken;
}

status::Fold fold_of(const NodeDriver& driver) {
  const LineEnds second = driver.ends(core::Line::second);
  return {driver.controller().input_folded(), driver.controller().output_line() == core::Line::second,
          second.from ? "up" : "down", second.to ? "up" : "down"};
}

/// A refused node tries again many times a second, so a refusal older than this is over.
constexpr std::chrono::seconds kRefusalLasts{3};

void add_refusals(std::vector<status::Refusal>& all, const StatusSources& from, const link::Refusals* refusals,
                  bool we_refuse) {
  if (refusals == nullptr) return;
  for (const auto& [node, refusal] : refusals->all()) {
    if (link::Clock::now() - refusal.at > kRefusalLasts) continue;
    const std::uint8_t refused = we_refuse ? node : from.node.id, by = we_refuse ? from.node.id : node;
    all.push_back({refused, by, refusal.reason,
                   "node " + from.ring.name_of(refused) + " is refused by node " + from.ring.name_of(by) + ": " +
                       refusal.reason});
  }
}

std::vector<status::Refusal> refusals_of(const StatusSources& from) {
  std::vector<status::Refusal> all;
  for (const core::Line line : core::Lines(from.driver.has_second_line())) {
    const LineRefusals refusals = from.driver.refusals(line);
    add_refusals(all, from, refusals.by_input, true);
    add_refusals(all, from, refusals.of_output, false);
  }
  return all;
}

status::Heard heard_of(const config::NodeConfig& node, const core::Peer& peer, core::Time now) {
  status::Heard row;
  row.id = node.id;
  row.name = node.name;
  row.boot = peer.boot;
  row.hop = peer.hop;
  row.age_ms = count_of<std::chrono::milliseconds>(now - peer.heard_at);
  row.beacon = peer.beacon;
  if (row.beacon.break_known)
    row.broken_line = status::BrokenLine{row.beacon.break_before, row.beacon.break_behind, {}, {}};
  return row;
}

status::LatelyDamaged lately_damaged_of(const StatusSources& from) {
  const LatelyDamaged::Counts lately = from.lately_damaged.counts(from.driver.now());
  return {LatelyDamaged::kWindow.count(), seconds_of(lately.oldest), lately.crc_errors, lately.returns_damaged};
}

status::Supervisor supervisor_of(const StatusSources& from) {
  const Watchdog& watcher = from.supervisor->watchdog();
  status::Supervisor row{watchdog::to_string(watcher.policy()), {}};
  for (const WatchedCpu& cpu : watcher.watched()) {
    status::WatchedCpu& watched = row.watched.emplace_back();
    watched.id = cpu.node;
    watched.name = from.ring.find(cpu.node)->name;
    watched.verdict = to_string(cpu.verdict);
    watched.for_ms = count_of<std::chrono::milliseconds>(from.driver.now() - cpu.since);
    watched.hangs = cpu.hangs;
    watched.resets = cpu.resets;
    watched.confirmed = cpu.confirmed;
    watched.tries = cpu.tries;
    watched.given_up = cpu.given_up;
    watched.last = cpu.last;
    watched.reset_reason = cpu.reset_reason;
  }
  return row;
}

/// Above all what no other field can show.
std::vector<status::Warning> warnings_of(const StatusSources& from) {
  std::vector<status::Warning> all;
  const auto add = [&all](const std::string& rule, const std::string& text) {
    if (!text.empty()) all.push_back({rule, text});
  };
  add("descriptors", too_few_descriptors(from.ring));
  if (from.turns != nullptr) add("holds_time", from.turns->holds_time(from.node.id));
  for (const Warning& warning : from.neighbours.warnings()) add(warning.rule, warning.text);
  for (const Warning& warning : from.cpu.watch().warnings()) add(warning.rule, warning.text);
  return all;
}

}  // namespace

NodeRow status_row(const StatusSources& from, bool with_heard) {
  const NodeDriver& driver = from.driver;
  const core::Membership& membership = driver.controller().membership();
  const LineEnds ends = driver.ends(core::Line::first);
  NodeRow row;
  row.id = from.node.id;
  row.name = from.node.name;
  row.state = to_string(membership.state());
  row.ring = from.ring.ring;
  row.pid = ::getpid();
  row.cpu = cpu_of(from.cpu, driver.now());
  row.ring_size = membership.ring_size();
  row.boot = membership.boot();
  row.uptime_s = seconds_of(driver.now() - driver.started());
  row.input = input_of(ends);
  row.output = output_of(ends, driver.controller().settings());
  row.round_trip_us = from.round_trips.row(driver.now());
  row.received = driver.controller().counters().received_data;
  row.waiting = driver.controller().received_waiting();
  row.broken_line = broken_line_of(from);
  row.faults = from.faults.list();
  row.refusals = refusals_of(from);
  row.warnings = warnings_of(from);
  row.counters = counters_of(from);
  row.lately_damaged = lately_damaged_of(from);
  for (const auto& node : from.ring.nodes)
    if (const core::Peer& peer = membership.peers()[wire::NodeId{node.id}]; with_heard && peer.known)
      row.heard.push_back(heard_of(node, peer, driver.now()));
  if (driver.has_second_line()) row.fold = fold_of(driver);
  if (from.supervisor) row.supervisor = supervisor_of(from);
  return row;
}

}  // namespace limb_ring::runtime
