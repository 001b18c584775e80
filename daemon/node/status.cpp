#include "node/status.h"

#include <unistd.h>

#include "io/process_state.h"
#include "node/node.h"
#include "node/realtime.h"

namespace limb_ring::runtime {
namespace {

using nlohmann::json;

json stop_json(const CpuSocket::Stop& stop, core::Time now) {
  using std::chrono::duration_cast, std::chrono::milliseconds;
  return {{"latched", stop.latched},
          {"latches", stop.latches},
          {"pulled", stop.pulled},
          {"pulled_ms", stop.pulled_at ? json(duration_cast<milliseconds>(now - *stop.pulled_at).count()) : json()}};
}

json cpu_json(const CpuSocket& cpu, core::Time now) {
  const CpuStatus s = cpu.status();
  return {{"kind", to_string(s.kind)},
          {"pid", s.pid > 0 ? json(s.pid) : json()},
          {"hung", s.pid > 0 && process::is_stopped(s.pid)},
          {"boots", s.boots},
          {"state", to_string(s.state)},
          {"silent_ms", s.silent.count()},
          {"alive_period_ms", s.alive_period.count()},
          {"restarted_by_owner", s.restarted_by_owner},
          {"resets", s.resets},
          {"last_reset", s.last_reset_reason},
          {"exits", s.exits},
          {"failed_boots", s.failed_boots},
          {"stop", stop_json(cpu.stop_state(), now)},
          {"last_exit", s.last_exit}};
}

/// The rate of the line out of the node; null if the line is as fast as the host.
json rate_json(const core::Settings& settings) {
  const std::int64_t byte_time = core::picoseconds(settings.byte_time_out);
  return byte_time == 0 ? json() : json(8 * core::Duration::period::den / byte_time);
}

/// Puts each counter under its name behind `prefix`.
auto into(json& all, const char* prefix) {
  return
      [&all, prefix](const char* name, const char*, std::uint64_t value) { all[std::string(prefix) + name] = value; };
}

/// What faults on purpose did is added to the counts of the first line; the links' counters have names of their own.
void add_second_line(const NodeDriver& driver, json& all) {
  driver.breaker(core::Line::second).counters().each([&](const char* name, const char*, std::uint64_t value) {
    all[name] = all[name].get<std::uint64_t>() + value;
  });
  driver.input_counters(core::Line::second).each(into(all, "second_input_"));
  driver.output_counters(core::Line::second).each(into(all, "second_output_"));
}

json counters_json(const StatusSources& from) {
  json all = json::object();
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
json broken_line_json(const StatusSources& from) {
  const auto line = from.driver.controller().membership().broken_line();
  if (!line) return {};
  const NodeDriver& driver = from.driver;
  const bool behind = line->behind == from.node.id;
  const core::Time since = behind ? driver.input_lost_at() : driver.broken_since();
  json broken{{"before", std::uint8_t{line->before}},
              {"behind", std::uint8_t{line->behind}},
              {"since_s", std::chrono::duration<double>(driver.now() - since).count()}};
  // If the node was folded already, around another break, its state does not change and broken_since() is older.
  if (behind && driver.broken_since() >= since)
    broken["announced_ms"] = std::chrono::duration<double, std::milli>(driver.broken_since() - since).count();
  return broken;
}

json fold_json(const NodeDriver& driver) {
  const LineEnds second = driver.ends(core::Line::second);
  return {{"input", driver.controller().input_folded()},
          {"output", driver.controller().output_line() == core::Line::second},
          {"second_input", second.from ? "up" : "down"},
          {"second_output", second.to ? "up" : "down"}};
}

/// A refused node tries again many times a second, so a refusal older than this is over.
constexpr std::chrono::seconds kRefusalLasts{3};

void add_refusals(json& all, const StatusSources& from, const link::Refusals* refusals, bool we_refuse) {
  if (refusals == nullptr) return;
  for (const auto& [node, refusal] : refusals->all()) {
    if (link::Clock::now() - refusal.at > kRefusalLasts) continue;
    const std::uint8_t refused = we_refuse ? node : from.node.id, by = we_refuse ? from.node.id : node;
    all.push_back({{"refused", refused},
                   {"by", by},
                   {"reason", refusal.reason},
                   {"text", "node " + from.ring.name_of(refused) + " is refused by node " + from.ring.name_of(by) +
                                ": " + refusal.reason}});
  }
}

json refusals_json(const StatusSources& from) {
  json all = json::array();
  for (const core::Line line : core::Lines(from.driver.has_second_line())) {
    const LineRefusals refusals = from.driver.refusals(line);
    add_refusals(all, from, refusals.by_input, true);
    add_refusals(all, from, refusals.of_output, false);
  }
  return all;
}

json told_break_json(const wire::Beacon& beacon) {
  if (!beacon.break_known) return {};
  return {{"before", std::uint8_t{beacon.break_before}}, {"behind", std::uint8_t{beacon.break_behind}}};
}

json heard_json(const StatusSources& from) {
  json heard = json::array();
  const core::Peers& peers = from.driver.controller().membership().peers();
  for (const auto& config : from.ring.nodes) {
    const core::Peer& peer = peers[wire::NodeId{config.id}];
    if (!peer.known) continue;
    const auto age = std::chrono::duration_cast<std::chrono::milliseconds>(from.driver.now() - peer.heard_at);
    heard.push_back({{"id", config.id},
                     {"name", config.name},
                     {"boot", peer.boot},
                     {"hop", peer.hop},
                     {"age_ms", age.count()},
                     {"cpu_boots", peer.beacon.cpu_boots},
                     {"cpu_state", wire::to_string(peer.beacon.cpu_state)},
                     {"cpu_silent_ms", peer.beacon.cpu_silent_ms},
                     {"cpu_comes_back", peer.beacon.cpu_comes_back},
                     {"input", wire::to_string(peer.beacon.input)},
                     {"output", wire::to_string(peer.beacon.output)},
                     {"broken_line", told_break_json(peer.beacon)},
                     {"stop_latched", peer.beacon.stop_latched},
                     {"latch", latch_json(peer.beacon.latch)}});
  }
  return heard;
}

json lately_damaged_json(const StatusSources& from) {
  const LatelyDamaged::Counts lately = from.lately_damaged.counts(from.driver.now());
  return {{"within_s", LatelyDamaged::kWindow.count()},
          {"oldest_s", std::chrono::duration<double>(lately.oldest).count()},
          {"crc_errors", lately.crc_errors},
          {"returns_damaged", lately.returns_damaged}};
}

json supervisor_json(const StatusSources& from) {
  const Watchdog& watcher = from.supervisor->watchdog();
  json watched = json::array();
  for (const WatchedCpu& cpu : watcher.watched()) {
    const auto age = std::chrono::duration_cast<std::chrono::milliseconds>(from.driver.now() - cpu.since);
    watched.push_back({{"id", std::uint8_t{cpu.node}},
                       {"name", from.ring.find(cpu.node)->name},
                       {"verdict", to_string(cpu.verdict)},
                       {"for_ms", age.count()},
                       {"hangs", cpu.hangs},
                       {"resets", cpu.resets},
                       {"confirmed", cpu.confirmed},
                       {"tries", cpu.tries},
                       {"given_up", cpu.given_up},
                       {"last", cpu.last},
                       {"reset_reason", cpu.reset_reason}});
  }
  return {{"policy", watchdog::to_string(watcher.policy())}, {"watched", watched}};
}

/// What is wrong at this node, each a sentence without its name. Above all what no other field can show.
json warnings_json(const StatusSources& from) {
  json all = json::array();
  const auto add = [&all](const std::string& rule, const std::string& text) {
    if (!text.empty()) all.push_back({{"rule", rule}, {"text", text}});
  };
  add("descriptors", too_few_descriptors(from.ring));
  if (from.turns != nullptr) add("holds_time", from.turns->holds_time(from.node.id));
  for (const Warning& warning : from.neighbours.warnings()) add(warning.rule, warning.text);
  for (const Warning& warning : from.cpu.watch().warnings()) add(warning.rule, warning.text);
  return all;
}

}  // namespace

json latch_json(const wire::ClockLatch& latch) {
  return {{"latched", latch.count != 0},
          {"source", std::uint8_t{latch.source}},
          {"count", latch.count},
          {"clock_ns", latch.clock_ns}};
}

json status_row(const StatusSources& from, bool with_heard) {
  const NodeDriver& driver = from.driver;
  const core::Membership& membership = driver.controller().membership();
  const LineEnds ends = driver.ends(core::Line::first);
  json row{{"id", from.node.id},
           {"name", from.node.name},
           {"state", to_string(membership.state())},
           {"pid", ::getpid()},
           {"cpu", cpu_json(from.cpu, driver.now())},
           {"ring_size", membership.ring_size()},
           {"boot", membership.boot()},
           {"uptime_s", std::chrono::duration<double>(driver.now() - driver.started()).count()},
           {"input", {{"state", ends.from ? "up" : "down"}, {"from", ends.from ? json(*ends.from) : json()}}},
           {"output",
            {{"state", ends.to ? "up" : "down"},
             {"to", ends.to ? json(*ends.to) : json()},
             {"rate_bit_s", rate_json(driver.controller().settings())}}},
           {"round_trip_us", from.round_trips.to_json(driver.now())},
           {"received", driver.controller().counters().received_data},
           {"waiting", driver.controller().received_waiting()},
           {"broken_line", broken_line_json(from)},
           {"faults", from.faults.list()},
           {"refusals", refusals_json(from)},
           {"warnings", warnings_json(from)},
           {"counters", counters_json(from)},
           {"lately_damaged", lately_damaged_json(from)}};
  if (with_heard) row["heard"] = heard_json(from);
  if (driver.has_second_line()) row["fold"] = fold_json(driver);
  if (from.supervisor) row["supervisor"] = supervisor_json(from);
  return row;
}

}  // namespace limb_ring::runtime
