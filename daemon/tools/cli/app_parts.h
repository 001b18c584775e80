#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace limb_ring::cli {

/// @name What a command line may hold, as CLI11 knows it
///@{
/// The names of its subcommands.
std::vector<std::string> subcommands_of(const CLI::App& app);
std::vector<const CLI::App*> subcommand_apps_of(const CLI::App& app);
/// Its own options and arguments, also those of its groups.
std::vector<const CLI::Option*> own_options_of(const CLI::App& app);
/// What it takes, options and arguments: its own, and of those above it what may stand behind it as well.
std::vector<const CLI::Option*> options_of(const CLI::App& app);
/// "--ring", "-n": of options_of().
std::vector<std::string> option_names(const CLI::App& app);
///@}

}  // namespace limb_ring::cli
