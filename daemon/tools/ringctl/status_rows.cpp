#include "tools/ringctl/status_rows.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "limb_ring/ring_directory.h"
#include "ring/live_faults.h"
#include "ring/ring_client.h"
#include "ring/ring_files.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/ring_access.h"
#include "wire/control_message.h"

namespace limb_ring::ringctl {

using status::NodeRow;

namespace {

/// "A -> B"; every node in the chain knows it.
std::string broken_line(const Rows& rows) {
  for (const NodeRow& row : rows)
    if (row.broken_line) return line_name(rows, row.broken_line->before, row.broken_line->behind);
  return "";
}

const NodeRow* row_of(const Rows& rows, std::uint8_t id) {
  const auto found = std::find_if(rows.begin(), rows.end(), [id](const NodeRow& row) { return row.id == id; });
  return found == rows.end() ? nullptr : &*found;
}

}  // namespace

std::string node_name(const Rows& rows, std::uint8_t id) {
  const NodeRow* row = row_of(rows, id);
  return row == nullptr ? std::to_string(id) : row->name;
}

std::string line_name(const Rows& rows, std::uint8_t before, std::uint8_t behind) {
  const NodeRow *from = row_of(rows, before), *to = row_of(rows, behind);
  const std::string host = from == nullptr ? "" : from->host, next = to == nullptr ? "" : to->host;
  const std::string between = host == next ? "" : " (from host " + host + " to host " + next + ")";
  return node_name(rows, before) + " -> " + node_name(rows, behind) + between;
}

NodeRow down_row(const NodeName& node) {
  NodeRow row;
  row.id = node.id;
  row.name = node.name;
  return row;
}

namespace {

/// The newest beacon of a node on another host that a node on this host has heard; null if it is too old.
const status::Heard* heard_of(const RingAccess& ring, const std::vector<ask::ToldRow>& told, std::uint8_t node) {
  const status::Heard* newest = nullptr;
  for (const ask::ToldRow& row : told) {
    if (!row.said) continue;
    for (const status::Heard& heard : row.said->heard)
      if (heard.id == node && (newest == nullptr || heard.age_ms < newest->age_ms)) newest = &heard;
  }
  const bool fresh =
      newest != nullptr && std::chrono::milliseconds(newest->age_ms) <= wire::kMissedBeacons * ring.beacon();
  return fresh ? newest : nullptr;
}

/// A node's state by its beacon, in the words of a status row. A beacon from away from the break says only that there
/// is one. Whether the ring is folded back, our own nodes tell: as they hear that node, they are in the same part.
std::string state_in(const status::Heard& heard, const std::vector<ask::ToldRow>& told) {
  constexpr auto kFolded = wire::LinkState::folded;
  if (heard.beacon.input == kFolded || heard.beacon.output == kFolded) return "folded";
  if (!heard.broken_line) return "up";
  const auto is_folded = [](const ask::ToldRow& row) { return row.said && row.said->state == "folded"; };
  return std::any_of(told.begin(), told.end(), is_folded) ? "folded" : "open_chain";
}

/// A daemon lives there, or may: its lock file cannot be looked at.
bool is_unanswered(const live::Holder& holder) {
  return (holder.held && !holder.frozen) || (!holder.held && !holder.problem.empty());
}

/// Of a node without a daemon of ours: a later life than that of the daemon which is dead here is heard, so somebody
/// else stands in for it.
bool is_of_another(const std::string& folder, std::uint8_t node, const status::Heard& heard) {
  const auto last = live::last_boot(folder, node);
  return !last || heard.boot > *last;
}

NodeRow absent_row(const RingAccess& ring, const std::vector<ask::ToldRow>& told, std::size_t place) {
  const NodeName& node = ring.nodes()[place];
  const std::string folder = ring_directory(ring.ring());
  const live::Holder holder = live::holder_of(folder, node.id);
  NodeRow row = down_row(node);
  row.ring = ring.ring();
  if (holder.held) row.pid = holder.pid;
  if (holder.frozen) row.state = "frozen";
  if (is_unanswered(holder)) {
    row.state = "unanswered";
    row.unanswered = told[place].why_not.empty() ? holder.problem : told[place].why_not;
  }
  if (const auto fault = live::noted_fault(folder, wire::NodeId{node.id})) row.faults = {*fault};
  const bool elsewhere = ring.hosts().empty() ? !holder.held : ring.is_elsewhere(node);
  const status::Heard* heard = elsewhere ? heard_of(ring, told, node.id) : nullptr;
  const bool here = ring.hosts().empty() && holder.pid > 0;
  if (heard == nullptr || (here && !is_of_another(folder, node.id, *heard))) return row;
  row.state = state_in(*heard, told);
  row.elsewhere = true;
  row.cpu.state = heard->cpu_state();
  row.cpu.boots = heard->beacon.cpu_boots;
  row.cpu.stop.emplace().latched = heard->beacon.stop_latched;
  row.latch = status::latch_of(heard->beacon.latch);
  row.broken_line = heard->broken_line;
  return row;
}

}  // namespace

Rows complete_rows(const RingAccess& ring, const std::vector<ask::ToldRow>& told) {
  Rows rows;
  for (std::size_t i = 0; i < told.size(); ++i) {
    rows.push_back(told[i].said ? *told[i].said : absent_row(ring, told, i));
    rows.back().host = ring.nodes()[i].host;
  }
  add_verdicts(rows);
  return rows;
}

Rows status_rows(const RingAccess& ring, Deadline deadline) {
  return complete_rows(ring, ask_for_rows(ring.ring(), ring.nodes(), deadline));
}

std::string cpu_word(const NodeRow& row) {
  if (row.cpu.verdict == "hung" || row.cpu.hung == true) return "hung";
  return row.cpu.stopped() ? "stopped" : row.cpu.state;
}

std::string round_trips_since(const Rows& rows) {
  double oldest_s = 0;
  for (const NodeRow& row : rows) oldest_s = std::max(oldest_s, row.round_trip_us.since_s.value_or(0));
  return oldest_s == 0 ? "" : "round trips of the last " + app::number(std::ceil(oldest_s), 0) + " s\n";
}

std::uint64_t errors_of(const NodeRow& row) {
  std::uint64_t all = 0;
  for (const ask::ErrorCounter& counter : ask::error_counters())
    if (counter.of_packets) all += row.counter(counter.name);
  return all;
}

std::string headline(const std::string& ring, const Rows& rows) {
  std::vector<ask::NodeInRing> nodes;
  // Of a node on another host nobody here knows the size.
  for (const NodeRow& row : rows) nodes.push_back({row.state, row.ring_size.value_or(0)});
  const auto unanswered = static_cast<std::size_t>(
      std::count_if(nodes.begin(), nodes.end(), [](const auto& node) { return node.state == "unanswered"; }));
  const std::string silent = unanswered == 0 ? "" : "; no answer from " + app::counted(unanswered, "node");
  return "ring " + ring + ": " + ask::ring_in_words(nodes, broken_line(rows)) + silent;
}

std::string unanswered_report(const Rows& rows) {
  std::string text;
  for (const NodeRow& row : rows)
    if (!row.unanswered.empty()) text += "no answer from " + row.name + ": " + row.unanswered + '\n';
  return text;
}

namespace {

/// What nodes warn of, such as too few file descriptors; empty if none does.
std::string warning_report(const Rows& rows) {
  std::map<std::string, std::string> names;  // by what is said
  for (const NodeRow& row : rows) {
    for (const status::Warning& warning : row.warnings) {
      std::string& all = names[warning.text];
      all += (all.empty() ? "" : ", ") + row.name;
    }
  }
  std::string text;
  for (const auto& [warning, all] : names) text += all + ": " + warning + '\n';
  return text;
}

/// "; 'ringctl log left_knee' shows what it printed" where that is kept on this host.
std::string where_it_printed(const NodeRow& row) {
  if (row.ring.empty() || live::log_of(ring_directory(row.ring), row.id).empty()) return {};
  return "; 'ringctl log " + row.name + "' shows what it printed";
}

/// The nodes whose daemon has ended by itself, if their logs are kept; empty if none has.
std::string down_report(const Rows& rows) {
  std::string text;
  for (const NodeRow& row : rows) {
    if (row.state != "down" || !row.faults.empty()) continue;
    const std::string where = where_it_printed(row);
    if (!where.empty()) text += "the daemon of " + row.name + " has ended" + where + '\n';
  }
  return text;
}

/// The CPUs that have failed, why, and the command that shows what they printed; empty if none has.
std::string cpu_report(const Rows& rows) {
  std::string text;
  for (const NodeRow& row : rows) {
    const std::string why = row.cpu.last_exit.value_or("");
    if (cpu_word(row) != "failed" || why.empty()) continue;
    const std::uint64_t boots = row.cpu.failed_boots.value_or(0);
    text += "CPU of " + row.name + " failed: " + why +
            (boots > 0 ? "; " + app::counted(boots, "start") + " in vain" : "") + where_it_printed(row) + '\n';
  }
  return text;
}

}  // namespace

std::string stop_report(const Rows& rows) {
  std::string names;
  std::size_t count = 0;
  for (const NodeRow& row : rows) {
    if (!row.cpu.stopped()) continue;
    ++count;
    names += (names.empty() ? "" : ", ") + row.name;
  }
  if (count == 0) return "";
  return "stopped: " + (count == rows.size() ? "all nodes" : names) + "; 'ringctl resume' ends it\n";
}

std::string whole_report(const Rows& rows) {
  return line_report(rows) + unanswered_report(rows) + down_report(rows) + cpu_report(rows) + warning_report(rows) +
         stop_report(rows) + supervision_text(rows);
}

namespace {

/// The row of the node that says it is the supervisor; nullptr if none does.
const NodeRow* supervisor_of(const Rows& rows) {
  const auto found = std::find_if(rows.begin(), rows.end(), [](const NodeRow& row) { return row.supervisor; });
  return found == rows.end() ? nullptr : &*found;
}

/// One line for all CPUs that are unreachable for the same reason, since a break can cut off half the ring.
std::string unreachable_lines(const std::vector<status::WatchedCpu>& watched) {
  std::map<std::string, std::string> names;  // by reason
  for (const status::WatchedCpu& cpu : watched)
    if (cpu.verdict == "unreachable" && cpu.hangs == 0) {
      std::string& all = names[cpu.last];
      all += (all.empty() ? "" : ", ") + cpu.name;
    }
  std::string lines;
  for (const auto& [reason, all] : names) lines += "  unreachable (" + reason + "): " + all + '\n';
  return lines;
}

std::string line_of(const status::WatchedCpu& cpu) {
  return "  " + cpu.name + ": " + cpu.verdict + " for " + app::number(static_cast<double>(cpu.for_ms) / 1000) + " s (" +
         cpu.last + "); " + app::counted(cpu.hangs, "hang") + ", " + app::counted(cpu.resets, "reset") + " by it, " +
         std::to_string(cpu.confirmed) + " confirmed\n";
}

}  // namespace

void add_verdicts(Rows& rows) {
  const NodeRow* supervisor = supervisor_of(rows);
  if (supervisor == nullptr) return;
  for (NodeRow& row : rows)
    for (const status::WatchedCpu& cpu : supervisor->supervisor->watched)
      if (cpu.id == row.id) row.cpu.verdict = cpu.verdict;
}

std::string supervision_text(const Rows& rows) {
  const NodeRow* supervisor = supervisor_of(rows);
  if (supervisor == nullptr) return {};
  std::string lines;
  for (const status::WatchedCpu& cpu : supervisor->supervisor->watched)
    if (cpu.hangs != 0) lines += line_of(cpu);
  lines += unreachable_lines(supervisor->supervisor->watched);
  if (lines.empty()) return {};
  return "supervisor " + supervisor->name + ", policy " + supervisor->supervisor->policy + ":\n" + lines;
}

namespace {

/// The node behind a break knows best; if it does not answer, any other that was told.
std::string broken_lines(const Rows& rows) {
  std::map<std::uint8_t, std::string> lines;  // by the node behind
  for (const NodeRow& row : rows) {
    if (!row.broken_line) continue;
    const status::BrokenLine& line = *row.broken_line;
    if (row.id != line.behind && lines.count(line.behind) != 0) continue;
    // The beacons of a node on another host say where the break is, but not since when.
    lines[line.behind] =
        "broken line " + line_name(rows, line.before, line.behind) +
        (line.since_s ? ", " + app::number(*line.since_s) + " s ago" : "") +
        (line.announced_ms ? ", announced " + app::number(*line.announced_ms / 1000, 3) + " s later" : "") + '\n';
  }
  std::string text;
  for (const auto& [behind, line] : lines) text += line;
  return text;
}

/// The node whose second line leads to the node at `place`: the next one, in ring order, that is there; null if none.
const NodeRow* answering_after(const Rows& rows, std::size_t place) {
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (const NodeRow& row = rows[(place + i) % rows.size()]; row.fold || row.elsewhere) return &row;
  return nullptr;
}

/// Reported because a broken second line has no other effect until a first line breaks, too, and then it is too late: a
/// fold uses all second lines but the one beside the break.
std::string broken_second_lines(const Rows& rows) {
  std::string text;
  for (std::size_t place = 0; place < rows.size(); ++place) {
    const NodeRow& row = rows[place];
    if (!row.fold || row.fold->second_input != "down") continue;
    if (const NodeRow* from = answering_after(rows, place))
      text += "broken second line " + line_name(rows, from->id, row.id) + ": the ring can fold back only around " +
              line_name(rows, row.id, from->id) + '\n';
  }
  return text;
}

/// Tolerance of noisy_line(): one in so many of a node's damaged packets may not have reached the next node yet.
constexpr std::uint64_t kUnderWay = 8;

/// A node that has been started since does not know any more which of them it has passed on.
bool may_have_passed_on(const NodeRow& from, const status::LatelyDamaged& seen) {
  return from.uptime_s.value_or(HUGE_VAL) <= seen.oldest_s;
}

/// The next node upstream of the one at `place` that counts damaged packets, and the lines from there, as a name. One
/// that does not count, such as another program in a node's place, may have passed on what was damaged before it.
struct Upstream {
  const NodeRow* counts = nullptr;  ///< null: none
  std::string lines;
};

Upstream upstream_of(const Rows& rows, std::uint8_t from, std::uint8_t node) {
  Upstream found{nullptr, line_name(rows, from, node)};
  const auto start = std::find_if(rows.begin(), rows.end(), [&](const NodeRow& row) { return row.id == from; });
  if (start == rows.end()) return found;
  const auto place = static_cast<std::size_t>(start - rows.begin());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const NodeRow& row = rows[(place + rows.size() - i) % rows.size()];
    if (row.id == node) break;
    if (i != 0) found.lines = node_name(rows, row.id) + " -> " + found.lines;
    if (!row.lately_damaged) continue;
    found.counts = &row;
    break;
  }
  return found;
}

/// A damaged packet is counted at every input that it reaches, so those that the previous node passed on are deducted:
/// all but its own, which end there. The rows are not of one instant, so a few packets may have been counted at one
/// node but not yet at the next.
std::string noisy_line(const Rows& rows, const NodeRow& row) {
  if (!row.input || !row.input->from || !row.lately_damaged || row.lately_damaged->crc_errors == 0) return {};
  const std::uint64_t seen = row.lately_damaged->crc_errors;
  const Upstream upstream = upstream_of(rows, *row.input->from, row.id);
  std::uint64_t passed_on = 0;
  if (upstream.counts != nullptr) {
    if (may_have_passed_on(*upstream.counts, *row.lately_damaged)) return {};
    const status::LatelyDamaged& before = *upstream.counts->lately_damaged;
    passed_on = before.crc_errors - std::min(before.crc_errors, before.returns_damaged);
  }
  const std::uint64_t damaged = seen - std::min(seen, passed_on);
  if (damaged <= seen / kUnderWay) return {};
  return "noisy line " + upstream.lines + ": " + app::counted(damaged, "packet") + " came in damaged in the last " +
         std::to_string(row.lately_damaged->within_s) + " s\n";
}

/// Both ends of a line may report a refusal, for the first and the second line. One report per pair of nodes is enough.
std::string refused_nodes(const Rows& rows) {
  std::map<std::pair<std::uint8_t, std::uint8_t>, std::string> lines;
  for (const NodeRow& row : rows)
    for (const status::Refusal& refusal : row.refusals)
      lines.emplace(std::minmax(refusal.refused, refusal.by), refusal.text);
  std::string text;
  for (const auto& [nodes, line] : lines) text += line + '\n';
  return text;
}

std::string faults_on_purpose(const NodeRow& row) {
  std::string text;
  for (const status::Fault& fault : row.faults)
    text += "fault on purpose " + row.name + '.' + fault.id.text + ": " + fault.fault + '\n';
  return text;
}

}  // namespace

std::string line_report(const Rows& rows) {
  std::string text = refused_nodes(rows) + broken_lines(rows) + broken_second_lines(rows);
  for (const NodeRow& row : rows) text += noisy_line(rows, row);
  for (const NodeRow& row : rows) text += faults_on_purpose(row);
  return text;
}

namespace {

/// Nothing arrives before it was sent: what is below 0 says by how much the latches are wrong.
void clamp(double& us, double& uncertain_us) {
  uncertain_us = std::max(uncertain_us, -us);
  us = std::max(us, 0.0);
}

}  // namespace

LineDelays line_delays(const std::vector<std::optional<std::int64_t>>& latches_ns,
                       const std::vector<std::string>& hosts, std::size_t source, double round_trip_us) {
  LineDelays all;
  all.between_hosts_us = round_trip_us;
  std::size_t from = source;
  for (std::size_t step = 1; step <= latches_ns.size(); ++step) {
    const std::size_t to = (source + step) % latches_ns.size();
    if (!latches_ns[to]) continue;
    LineDelay line{from, to, std::nullopt};
    if (hosts[from] == hosts[to]) {
      const double home_us = to == source ? round_trip_us : 0;  // it has latched when the interrupt left
      line.us = static_cast<double>(*latches_ns[to] - *latches_ns[from]) / 1000.0 + home_us;
      all.between_hosts_us -= *line.us;
      clamp(*line.us, all.uncertain_us);
    } else {
      ++all.between_hosts;
    }
    all.lines.push_back(line);
    from = to;
  }
  if (all.between_hosts == 0) all.between_hosts_us = 0;
  clamp(all.between_hosts_us, all.uncertain_us);
  return all;
}

}  // namespace limb_ring::ringctl
