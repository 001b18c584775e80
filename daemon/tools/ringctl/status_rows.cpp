#include "tools/ringctl/status_rows.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "limb_ring/ring_directory.h"
#include "ring/live_faults.h"
#include "ring/ring_files.h"
#include "ring/status_rows.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/answers.h"
#include "tools/ringctl/line_report.h"
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

namespace {

/// "; 'ringctl log left_knee' shows what it printed" where that is kept on this host.
std::string where_it_printed(const NodeRow& row) {
  if (row.ring.empty() || live::log_of(ring_directory(row.ring), row.id).empty()) return {};
  return "; 'ringctl log " + row.name + "' shows what it printed";
}

}  // namespace

std::string down_report(const Rows& rows) {
  std::string text;
  for (const NodeRow& row : rows) {
    if (row.state != "down" || !row.faults.empty()) continue;
    const std::string where = where_it_printed(row);
    if (!where.empty()) text += "the daemon of " + row.name + " has ended" + where + '\n';
  }
  return text;
}

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

/// The row of the node that says it is the supervisor; nullptr where none does.
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

}  // namespace limb_ring::ringctl
