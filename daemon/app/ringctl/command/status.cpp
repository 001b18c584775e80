#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>

#include "app/ringctl/answers.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/line_report.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/status_table.h"
#include "app/ringctl/supervision.h"
#include "inject/lock_files.h"
#include "limb_ring/ring_directory.h"
#include "runtime/supervisor/process_state.h"

namespace limb_ring::ringctl {

namespace {

/// Its daemon does not answer: stopped or dead is not the same.
nlohmann::json absent_row(const std::string& ring, const NodeName& node) {
  const inject::Holder holder = inject::holder_of(ring_directory(ring), node.id);
  nlohmann::json row = down_row(node);
  if (holder.held) row["pid"] = holder.pid;
  if (holder.held && runtime::is_stopped(holder.pid)) row["state"] = "frozen";
  return row;
}

std::vector<nlohmann::json> rows_of(const RingAccess& ring) {
  const auto answers = ask_all(ring.ring(), ring.nodes(), {{"do", "status"}});
  std::vector<nlohmann::json> rows;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    rows.push_back(answers[i] ? *answers[i] : absent_row(ring.ring(), ring.nodes()[i]));
    rows.back().erase("ring");  // once is enough
  }
  add_verdicts(rows);
  return rows;
}

std::string summary(const std::vector<nlohmann::json>& rows) {
  std::size_t up = 0, folded = 0, part = rows.size();
  for (const auto& row : rows) {
    const std::string state = row.value("state", "");
    if (state == "folded") part = std::min(part, row.value("ring_size", rows.size()));
    folded += state == "folded" ? 1 : 0;
    up += state == "up" || state == "folded" ? 1 : 0;
  }
  const char* fold = folded == 0 ? "" : part < up ? ", folded back in parts" : ", folded back around a break";
  return std::to_string(up) + " of " + std::to_string(rows.size()) + " nodes up" + fold;
}

int run(const Context& context, bool json) {
  const RingAccess ring = RingAccess::open(choose_ring(context.ring));
  const std::vector<nlohmann::json> rows = rows_of(ring);
  if (json) {
    const nlohmann::json all{{"ring", ring.ring()}, {"path", ring.path()}, {"nodes", rows}};
    std::cout << all.dump(2) << '\n';
  } else {
    std::cout << "ring " << ring.ring() << ": " << summary(rows) << '\n'
              << status_table(rows) << line_report(rows) << supervision_text(rows);
  }
  return kDone;
}

}  // namespace

void add_status(CLI::App& app, Context& context) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command =
      add_command(app, "status", "Show all nodes; one whose daemon does not answer is 'down', or, stopped, 'frozen'");
  add_json(*command, *json);
  command->callback(
      [&context, json] { context.action = [&context, json] { return run(context, *json); }; });
}

}  // namespace limb_ring::ringctl
