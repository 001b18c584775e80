#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace limb_ring::cli {

/// What is there to be named where a command line wants one: given "NODE" or "--ring", as --help calls the argument
/// or the option; nothing where that is no name.
using NamesOf = std::function<std::vector<std::string>(const std::string& wanted)>;

inline std::vector<std::string> no_names(const std::string&) { return {}; }

/// The words that may stand next on a command line, for a shell: subcommands, options, names; sorted.
/// @param words typed behind the program's name; the last is what they begin with, perhaps nothing yet
std::vector<std::string> completions(const CLI::App& app, const std::vector<std::string>& words, const NamesOf& names);

}  // namespace limb_ring::cli
