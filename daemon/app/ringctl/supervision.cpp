#include "app/ringctl/supervision.h"

#include "app/common/text_table.h"

namespace limb_ring::ringctl {

using nlohmann::json;

namespace {

/// The row of the node that says it is the supervisor; nullptr where none does.
const json* supervisor_of(const std::vector<json>& rows) {
  for (const json& row : rows)
    if (row.contains("supervisor")) return &row;
  return nullptr;
}

bool worth_a_line(const json& cpu) {
  return cpu["hangs"] != 0 || cpu["verdict"] == "unreachable";
}

std::string line_of(const json& cpu) {
  return "  " + cpu["name"].get<std::string>() + ": " + cpu["verdict"].get<std::string>() + " for " +
         app::number(cpu["for_ms"].get<double>() / 1000) + " s (" + cpu["last"].get<std::string>() + "); hung " +
         cpu["hangs"].dump() + ", resets " + cpu["resets"].dump() + ", confirmed " + cpu["confirmed"].dump() + '\n';
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
    if (worth_a_line(cpu)) lines += line_of(cpu);
  if (lines.empty()) return {};
  return "supervisor " + (*supervisor)["name"].get<std::string>() + ", policy " +
         (*supervisor)["supervisor"]["policy"].get<std::string>() + ":\n" + lines;
}

}  // namespace limb_ring::ringctl
