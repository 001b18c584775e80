#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "node/program_stage.h"
#include "sim/load_scenario.h"
#include "tools/common/command_line.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"

namespace limb_ring::ringctl {
namespace {

namespace fs = std::filesystem;

struct ScenarioListOptions {
  std::vector<std::string> places;
  bool as_json = false;
};

/// A file that was not meant as a scenario, or one with a mistake: the error text says which.
struct NoScenario {
  std::string file, why;
};

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".yaml" || entry.path().extension() == ".yml")
      files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

app::Row row_of(const std::string& file, bool as_json) {
  const auto scenario = scenario::load_scenario(file);
  const auto not_live = only_virtual(scenario, "");
  const auto not_virtual = program_stage::not_with_programs(scenario);
  const std::string where =
      std::string("sim") + (not_virtual.empty() ? ", virtual" : "") + (not_live.empty() ? ", live" : "");
  app::Row row{{"file", fs::path(file).filename().string()},
               {"where", where == "sim" ? "sim only" : where},
               {"scenario", scenario.name + (expects_something(scenario) ? "" : " (expects nothing)")}};
  if (as_json) row["why_not_live"] = not_live;
  if (as_json) row["why_not_virtual"] = not_virtual;
  return row;
}

/// Adds all scenarios of a folder. Other files there are only named.
void add_folder(const std::string& folder, bool as_json, std::vector<app::Row>& rows, std::vector<NoScenario>& others) {
  const std::size_t before = rows.size() + others.size();
  for (const std::string& file : files_in(folder)) {
    try {
      rows.push_back(row_of(file, as_json));
    } catch (const config::ConfigError& error) {
      others.push_back({file, error.what()});
    }
  }
  if (rows.size() + others.size() == before) throw UsageError(folder + ": no scenario there (*.yaml)");
}

int run(const ScenarioListOptions& options) {
  std::vector<app::Row> rows;
  std::vector<NoScenario> others;
  for (const std::string& place : options.places) {
    if (fs::is_directory(place))
      add_folder(place, options.as_json, rows, others);
    else
      rows.push_back(row_of(place, options.as_json));
  }
  std::cout << app::format_rows(rows, options.as_json ? app::Format::json : app::Format::text);
  if (options.as_json) std::cout << '\n';
  for (const NoScenario& other : others) std::cerr << "not a scenario: " << other.why << '\n';
  return kDone;
}

}  // namespace

void add_scenario_list(CLI::App& scenario, Context& context) {
  auto options = std::make_shared<ScenarioListOptions>();
  CLI::App* command = add_command(scenario, "list", "Show what scenarios are about, and where they run",
                                  "ringctl scenario list scenarios/");
  command->add_option("PLACE", options->places, "Scenarios, or folders of them")->required();
  add_json(*command, options->as_json);
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

}  // namespace limb_ring::ringctl
