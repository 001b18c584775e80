#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace limb_ring::cli {

/// The man page of a program, in roff: the same table that --help prints, with all subcommands.
/// @param app has a name, the program's, and a formatter that calls its options as --help does
std::string man_page(const CLI::App& app);

}  // namespace limb_ring::cli
