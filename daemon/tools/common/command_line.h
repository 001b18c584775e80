#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/common/man_page.h"

namespace limb_ring::cli {

/// A command line is wrong; what() says what, and what would be right.
struct WrongCommandLine : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// "1.2.3"
const char* version();

/// What a --help ends with: `more`, the example in a line of its own, the exit codes. Each may be empty.
std::string footer(const std::string& more, const std::string& example, const std::string& exit_codes);

/// Reads a command line into the options of `app`. Every program also has --help, --version and `help`, and if it has
/// subcommands `help SUBCOMMAND`; for shells `complete WORD...`, which prints the words that may come next; and for the
/// build `man-page`. Arguments that roslaunch adds at the end are ignored.
/// @param app has a name, the program's
/// @param arguments without the program's name
/// @param names for `complete`
/// @return a text that was asked for (help, of at most 80 columns, version, completions); nothing if the options are
/// to be acted on
/// @throw WrongCommandLine in plain words, with a guess at what was meant
std::optional<std::string> read(CLI::App& app, std::vector<std::string> arguments, const NamesOf& names = no_names);

/// As read(): prints what was asked for on standard output, what is wrong on standard error.
/// @return what the program is to end with, 0 or 2; nothing if the options are to be acted on
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv, const NamesOf& names = no_names);

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

/// @name What an option's value may be, for `->transform(...)`
/// Numbers are taken as people write them (config/quantity.h) and refused in plain words.
///@{
/// A whole number, also 1e6 or 64k.
CLI::Validator whole(std::int64_t least, std::int64_t most);
/// A number, also 1e-3.
CLI::Validator real(double least, double most);
/// A time for an option that holds seconds: 5ms, 2s; a plain number is seconds. In seconds.
CLI::Validator seconds(double least, double most);
/// The same to the nanosecond, for an option that holds nanoseconds.
CLI::Validator nanoseconds(std::chrono::nanoseconds least, std::chrono::nanoseconds most);
/// Time of a virtual clock per real time: a number, or max, which is infinite.
CLI::Validator pace();
/// One of these words.
CLI::Validator one_of(std::vector<std::string> words);
///@}

/// A word that stands for a value of an enumeration.
template <typename Enum>
CLI::Validator word_of(const std::map<std::string, Enum>& values) {
  std::vector<std::string> words;
  for (const auto& [word, value] : values) words.push_back(word);
  CLI::Validator validator = one_of(words);
  return CLI::Validator(
      [validator, values](std::string& text) {
        const std::string wrong = validator(text);
        if (wrong.empty()) text = std::to_string(static_cast<int>(values.at(text)));
        return wrong;
      },
      "");
}

/// Writes what is held back.
/// @return what is wrong: the file and the system's reason, as far as it is known; empty if all has been written
std::string finish_writing(std::ostream& out, const std::string& path);

/// Exit code of a program that would end with `code`: 1 instead of 0, and a line on standard error, if standard
/// output could not take all that was written.
int code_with_output(const std::string& program, int code);

/// SIGINT, SIGTERM and SIGHUP end this process at once with 1 and "PROGRAM: interrupted" on standard error; a signal
/// that is ignored, as by nohup, stays ignored. For programs that only compute and have nothing to clean up.
void end_interrupted_with_one(const std::string& program);

}  // namespace limb_ring::cli
