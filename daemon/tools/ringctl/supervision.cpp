#include "tools/ringctl/supervision.h"

#include <map>

#include "tools/common/text_table.h"

namespace limb_ring::ringctl {

using nlohmann::json;

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
