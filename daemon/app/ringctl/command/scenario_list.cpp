#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "app/common/rows.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "study/scenario/load_scenario.h"
#include "study/scenario/only_virtual.h"

namespace limb_ring::ringctl {

namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> places;
  bool json = false;
};

std::vector<std::string> files_of(const std::string& place) {
  if (!fs::is_directory(place)) return {place};
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(place))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw UsageError(place + ": no scenario there (*.yaml)");
  return files;
}

app::Row row_of(const std::string& file, bool json) {
  const auto scenario = study::scenario::load_scenario(file);
  const auto reasons = only_virtual(scenario, "");
  app::Row row{{"file", fs::path(file).filename().string()},
               {"where", reasons.empty() ? "sim, live" : "sim only"},
               {"scenario", scenario.name}};
  if (json) row["why_not_live"] = reasons;
  return row;
}

int run(const Options& options) {
  std::vector<app::Row> rows;
  for (const std::string& place : options.places)
    for (const std::string& file : files_of(place)) rows.push_back(row_of(file, options.json));
  std::cout << app::format_rows(rows, options.json ? app::Format::json : app::Format::text);
  if (options.json) std::cout << '\n';
  return kDone;
}

}  // namespace

void add_scenario_list(CLI::App& scenario, Context& context) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(scenario, "list", "What scenarios are about, and where they can be run");
  command->add_option("PLACE", options->places, "Scenarios, or folders of them")->required();
  add_json(*command, options->json);
  command->callback([&context, options] {
    context.action = [options] { return run(*options); };
  });
}

}  // namespace limb_ring::ringctl
