#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/cli/completion.h"

namespace limb_ring::cli {

/// A command line is wrong; what() says what, and what would be right.
struct WrongCommandLine : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// "1.2.3"
const char* version();

/// What a --help ends with: `more`, the example in a line of its own, the exit codes. Each may be empty.
std::string footer(const std::string& more, const std::string& example, const std::string& exit_codes);

/// Reads a command line into the options of `app`. Beside these every program has --help, --version, `help`, and
/// where it has subcommands `help SUBCOMMAND`; for shells `complete WORD...`, the words that may stand next; and for
/// the build `man-page`. What roslaunch adds at the end is passed over.
/// @param app has a name, the program's
/// @param arguments without the program's name
/// @param names for `complete`
/// @return a text that was asked for (help, of at most 80 columns, version, completions); nothing where the options are
/// to be acted on
/// @throw WrongCommandLine in plain words, with a guess at what was meant
std::optional<std::string> read(CLI::App& app, std::vector<std::string> arguments, const NamesOf& names = no_names);

/// As read(): prints what was asked for on standard output, what is wrong on standard error.
/// @return what the program is to end with, 0 or 2; nothing where the options are to be acted on
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv, const NamesOf& names = no_names);

}  // namespace limb_ring::cli
