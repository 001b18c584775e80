#include "tools/ringctl/line_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "tools/common/text_table.h"
#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {

using status::NodeRow;

namespace {

/// The node behind a break knows best; where it does not answer, any other that was told.
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
