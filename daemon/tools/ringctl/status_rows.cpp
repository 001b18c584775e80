#include "tools/ringctl/status_rows.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "config/fault.h"
#include "io/node_notes.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "ring/status_rows.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/answers.h"
#include "wire/control_message.h"

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

bool stopped(const json& row) {
  const json::json_pointer place("/cpu/stop/latched");
  return row.contains(place) && row.at(place) == true;
}

/// "A -> B"; every node in the chain knows it.
std::string broken_line(const std::vector<json>& rows) {
  for (const json& row : rows) {
    const json line = row.value("broken_line", json());
    if (line.is_object()) return line_name(rows, line.at("before"), line.at("behind"));
  }
  return "";
}

/// The fault of a whole node, as noted in the ring's folder. The note is ignored if it no longer fits the node's state.
json faults_of_absent(const std::string& folder, std::uint8_t node, bool frozen) {
  const auto note = live::note_of(folder, wire::NodeId{node});
  const bool fits = frozen ? note && note->name() == fault::word_of(fault::Name::freeze).word
                           : live::is_killed(folder, wire::NodeId{node});
  if (!fits) return json::array();
  return {{{"id", note->name()}, {"fault", note->words}}};
}

}  // namespace

std::string node_name(const std::vector<json>& rows, const json& id) {
  for (const json& row : rows)
    if (row.value("id", json()) == id) return row.value("name", id.dump());
  return id.dump();
}

std::string host_name(const std::vector<json>& rows, const json& id) {
  for (const json& row : rows)
    if (row.value("id", json()) == id) return row.value("host", "");
  return "";
}

std::string line_name(const std::vector<json>& rows, const json& before, const json& behind) {
  const std::string from = host_name(rows, before), to = host_name(rows, behind);
  const std::string between = from == to ? "" : " (from host " + from + " to host " + to + ")";
  return node_name(rows, before) + " -> " + node_name(rows, behind) + between;
}

json down_row(const NodeName& node) {
  return {{"id", node.id},
          {"name", node.name},
          {"state", "down"},
          {"pid", nullptr},
          {"cpu", {{"pid", nullptr}, {"boots", nullptr}, {"state", "unknown"}}},
          {"ring_size", nullptr},
          {"round_trip_us", {{"p50", nullptr}, {"p99", nullptr}, {"max", nullptr}, {"since_s", nullptr}}},
          {"counters", json::object()}};
}

namespace {

/// The newest beacon of a node on another host that a node on this host has heard; null if it is too old.
json heard_of(const RingAccess& ring, const std::vector<Answer>& answers, std::uint8_t node) {
  json newest;
  for (const Answer& answer : answers)
    for (const json& heard : answer.said ? answer.said->value("heard", json::array()) : json::array())
      if (heard.value("id", 0) == node && (newest.is_null() || heard.value("age_ms", 0) < newest.value("age_ms", 0)))
        newest = heard;
  const bool fresh =
      !newest.is_null() && std::chrono::milliseconds(newest.value("age_ms", 0)) <= wire::kMissedBeacons * ring.beacon();
  return fresh ? newest : json();
}

/// A node's state by its beacon, in the words of a status row. A beacon from away from the break says only that there
/// is one. Whether the ring is folded back, our own nodes tell: as they hear that node, they are in the same part.
json state_in(const json& heard, const std::vector<Answer>& answers) {
  for (const char* line : {"input", "output"})
    if (heard.value(line, "") == wire::to_string(wire::LinkState::folded)) return "folded";
  if (!heard.value("broken_line", json()).is_object()) return "up";
  const auto is_folded = [](const Answer& answer) {
    return answer.said && answer.said->value("state", "") == "folded";
  };
  return std::any_of(answers.begin(), answers.end(), is_folded) ? "folded" : "open_chain";
}

/// A daemon lives there, or may: its lock file cannot be looked at.
bool is_unanswered(const live::Holder& holder) {
  return (holder.held && !holder.frozen) || (!holder.held && !holder.problem.empty());
}

/// Of a node without a daemon of ours: a later life than that of the daemon which is dead here is heard, so somebody
/// else stands in for it.
bool is_of_another(const std::string& folder, std::uint8_t node, const json& heard) {
  const auto last = live::last_boot(folder, node);
  return !last || heard.value("boot", std::uint64_t{0}) > *last;
}

json absent_row(const RingAccess& ring, const std::vector<Answer>& answers, std::size_t place) {
  const NodeName& node = ring.nodes()[place];
  const std::string folder = ring_directory(ring.ring());
  const live::Holder holder = live::holder_of(folder, node.id);
  json row = down_row(node);
  row["ring"] = ring.ring();
  if (holder.held) row["pid"] = holder.pid;
  if (holder.frozen) row["state"] = "frozen";
  if (is_unanswered(holder)) {
    row["state"] = "unanswered";
    row["unanswered"] = answers[place].why_not.empty() ? holder.problem : answers[place].why_not;
  }
  row["faults"] = faults_of_absent(folder, node.id, row["state"] == "frozen");
  const bool elsewhere = ring.hosts().empty() ? !holder.held : ring.is_elsewhere(node);
  const json heard = elsewhere ? heard_of(ring, answers, node.id) : json();
  const bool here = ring.hosts().empty() && holder.pid > 0;
  if (heard.is_null() || (here && !is_of_another(folder, node.id, heard))) return row;
  row["state"] = state_in(heard, answers);
  row["elsewhere"] = true;
  row["cpu"]["state"] = heard.value("cpu_state", "unknown");
  row["cpu"]["boots"] = heard.value("cpu_boots", 0);
  row["cpu"]["stop"] = {{"latched", heard.value("stop_latched", false)}};
  row["latch"] = heard.value("latch", json::object());
  row["broken_line"] = heard.value("broken_line", json());
  return row;
}

}  // namespace

std::vector<json> complete_rows(const RingAccess& ring, std::vector<Answer> answers) {
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const std::string wrong = answers[i].said ? wrong_in_row(*answers[i].said, ring.nodes()[i].id) : "";
    if (!wrong.empty()) answers[i] = {std::nullopt, sentence_of_shape(wrong)};
  }
  std::vector<json> rows;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    rows.push_back(answers[i].said ? *answers[i].said : absent_row(ring, answers, i));
    if (const std::string& host = ring.nodes()[i].host; !host.empty()) rows.back()["host"] = host;
  }
  add_verdicts(rows);
  return rows;
}

std::vector<json> status_rows(const RingAccess& ring, Deadline deadline) {
  return complete_rows(ring, ask_all(ring.ring(), ring.nodes(), {{"do", "status"}}, deadline));
}

std::string cpu_word(const json& row) {
  const json cpu = row.value("cpu", json::object());
  if (cpu.value("verdict", "") == "hung" || cpu.value("hung", false)) return "hung";
  return stopped(row) ? "stopped" : cpu.value("state", "unknown");
}

std::string round_trips_since(const std::vector<json>& rows) {
  double oldest_s = 0;
  for (const json& row : rows) {
    const json since = row.value(json::json_pointer("/round_trip_us/since_s"), json());
    if (since.is_number()) oldest_s = std::max(oldest_s, since.get<double>());
  }
  return oldest_s == 0 ? "" : "round trips of the last " + app::number(std::ceil(oldest_s), 0) + " s\n";
}

std::uint64_t counter_of(const json& row, const std::string& name) {
  return row.contains("counters") ? row["counters"].value(name, std::uint64_t{0}) : 0;
}

std::uint64_t errors_of(const json& row) {
  std::uint64_t all = 0;
  for (const ask::ErrorCounter& counter : ask::error_counters())
    if (counter.of_packets) all += counter_of(row, counter.name);
  return all;
}

std::string headline(const std::string& ring, const std::vector<json>& rows) {
  std::vector<ask::NodeInRing> nodes;
  for (const json& row : rows) {
    const json size = row.value("ring_size", json());  // of a node on another host nobody here knows it
    nodes.push_back({row.value("state", ""), size.is_number() ? size.get<std::size_t>() : 0});
  }
  const auto unanswered = static_cast<std::size_t>(
      std::count_if(nodes.begin(), nodes.end(), [](const auto& node) { return node.state == "unanswered"; }));
  const std::string silent = unanswered == 0 ? "" : "; no answer from " + app::counted(unanswered, "node");
  return "ring " + ring + ": " + ask::ring_in_words(nodes, broken_line(rows)) + silent;
}

std::string unanswered_report(const std::vector<json>& rows) {
  std::string text;
  for (const json& row : rows)
    if (row.contains("unanswered"))
      text += "no answer from " + row.value("name", "") + ": " + row.value("unanswered", "") + '\n';
  return text;
}

std::string warning_report(const std::vector<json>& rows) {
  std::map<std::string, std::string> names;  // by what is said
  for (const json& row : rows) {
    for (const json& warning : row.value("warnings", json::array())) {
      std::string& all = names[warning.at("text").get<std::string>()];
      all += (all.empty() ? "" : ", ") + row.value("name", "");
    }
  }
  std::string text;
  for (const auto& [warning, all] : names) text += all + ": " + warning + '\n';
  return text;
}

namespace {

/// "; 'ringctl log left_knee' shows what it printed" where that is kept on this host.
std::string where_it_printed(const json& row) {
  const std::string ring = row.value("ring", "");
  if (ring.empty() || live::log_of(ring_directory(ring), row.value("id", std::uint8_t{0})).empty()) return {};
  return "; 'ringctl log " + row.value("name", "") + "' shows what it printed";
}

}  // namespace

std::string down_report(const std::vector<json>& rows) {
  std::string text;
  for (const json& row : rows) {
    const bool on_purpose = !row.value("faults", json::array()).empty();
    if (row.value("state", "") != "down" || on_purpose) continue;
    const std::string where = where_it_printed(row);
    if (!where.empty()) text += "the daemon of " + row.value("name", "") + " has ended" + where + '\n';
  }
  return text;
}

std::string cpu_report(const std::vector<json>& rows) {
  std::string text;
  for (const json& row : rows) {
    const json cpu = row.value("cpu", json::object());
    const json why = cpu.value("last_exit", json());
    if (cpu_word(row) != "failed" || !why.is_string() || why.get<std::string>().empty()) continue;
    const auto boots = cpu.value("failed_boots", std::uint64_t{0});
    text += "CPU of " + row.value("name", "") + " failed: " + why.get<std::string>() +
            (boots > 0 ? "; " + app::counted(boots, "start") + " in vain" : "") + where_it_printed(row) + '\n';
  }
  return text;
}

std::string stop_report(const std::vector<json>& rows) {
  std::string names;
  std::size_t count = 0;
  for (const json& row : rows) {
    if (!stopped(row)) continue;
    ++count;
    names += (names.empty() ? "" : ", ") + row.value("name", "");
  }
  if (count == 0) return "";
  return "stopped: " + (count == rows.size() ? "all nodes" : names) + "; 'ringctl resume' ends it\n";
}

namespace {

/// The row of the node that says it is the supervisor; nullptr where none does.
const json* supervisor_of(const std::vector<json>& rows) {
  for (const json& row : rows)
    if (row.contains("supervisor")) return &row;
  return nullptr;
}

bool has_hung(const json& cpu) { return cpu["hangs"] != 0; }

/// One line for all CPUs that are unreachable for the same reason, since a break can cut off half the ring.
std::string unreachable_lines(const json& watched) {
  std::map<std::string, std::string> names;  // by reason
  for (const json& cpu : watched)
    if (cpu["verdict"] == "unreachable" && !has_hung(cpu)) {
      std::string& all = names[cpu["last"].get<std::string>()];
      all += (all.empty() ? "" : ", ") + cpu["name"].get<std::string>();
    }
  std::string lines;
  for (const auto& [reason, all] : names) lines += "  unreachable (" + reason + "): " + all + '\n';
  return lines;
}

std::string line_of(const json& cpu) {
  return "  " + cpu["name"].get<std::string>() + ": " + cpu["verdict"].get<std::string>() + " for " +
         app::number(cpu["for_ms"].get<double>() / 1000) + " s (" + cpu["last"].get<std::string>() + "); " +
         app::counted(cpu["hangs"].get<std::uint64_t>(), "hang") + ", " +
         app::counted(cpu["resets"].get<std::uint64_t>(), "reset") + " by it, " + cpu["confirmed"].dump() +
         " confirmed\n";
}

}  // namespace

void add_verdicts(std::vector<json>& rows) {
  const json* supervisor = supervisor_of(rows);
  if (supervisor == nullptr) return;
  const json watched = (*supervisor)["supervisor"]["watched"];
  for (json& row : rows)
    for (const json& cpu : watched)
      if (cpu["id"] == row["id"]) row["cpu"]["verdict"] = cpu["verdict"];
}

std::string supervision_text(const std::vector<json>& rows) {
  const json* supervisor = supervisor_of(rows);
  if (supervisor == nullptr) return {};
  std::string lines;
  for (const json& cpu : (*supervisor)["supervisor"]["watched"])
    if (has_hung(cpu)) lines += line_of(cpu);
  lines += unreachable_lines((*supervisor)["supervisor"]["watched"]);
  if (lines.empty()) return {};
  return "supervisor " + (*supervisor)["name"].get<std::string>() + ", policy " +
         (*supervisor)["supervisor"]["policy"].get<std::string>() + ":\n" + lines;
}

}  // namespace limb_ring::ringctl
