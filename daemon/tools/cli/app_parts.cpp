#include "tools/cli/app_parts.h"

namespace limb_ring::cli {

namespace {

/// Of options alone: a group of options is a subcommand without a name to CLI11.
std::vector<const CLI::App*> parts_of(const CLI::App& app, bool named) {
  std::vector<const CLI::App*> parts;
  for (const CLI::App* part : app.get_subcommands([](const CLI::App*) { return true; }))
    if (part->get_name().empty() != named) parts.push_back(part);
  return parts;
}

void add_options(const CLI::App& app, std::vector<const CLI::Option*>& all) {
  for (const CLI::Option* option : app.get_options()) all.push_back(option);
  for (const CLI::App* group : parts_of(app, false)) add_options(*group, all);
}

}  // namespace

std::vector<std::string> subcommands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* part : parts_of(app, true)) names.push_back(part->get_name());
  return names;
}

std::vector<const CLI::App*> subcommand_apps_of(const CLI::App& app) { return parts_of(app, true); }

std::vector<const CLI::Option*> own_options_of(const CLI::App& app) {
  std::vector<const CLI::Option*> all;
  add_options(app, all);
  return all;
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  std::vector<const CLI::Option*> all;
  for (const CLI::App* at = &app; at != nullptr; at = at->get_fallthrough() ? at->get_parent() : nullptr)
    add_options(*at, all);
  return all;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options_of(app)) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

}  // namespace limb_ring::cli
