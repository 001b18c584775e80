#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace limb_ring::cli {

/// The man page of a program, in roff: the same table that --help prints, with all subcommands.
/// @param app has a name, the program's, and a formatter that calls its options as --help does
std::string man_page(const CLI::App& app);

/// Text escaped for a man page, so that roff interprets none of it.
std::string roff(const std::string& text);

/// A man page of a program, up to where its own sections begin: header, NAME, SYNOPSIS.
/// @param name the program's
/// @param what it is, as a sentence
/// @param usage what may follow its name
std::string man_page_begin(const std::string& name, const std::string& what, const std::string& usage);

/// What is the same in all pages: FILES, SEE ALSO.
std::string man_page_end(const std::string& name);

/// The page of a program that has only a text for --help.
/// @param help as it is printed: its first line is "NAME: what it is", then lines to be kept as they are
std::string man_page_of_text(const std::string& name, const std::string& help, const std::string& usage);

/// What is there to be named if a command line wants one: given "NODE" or "--ring", as --help calls the argument
/// or the option; nothing if that is not a name.
using NamesOf = std::function<std::vector<std::string>(const std::string& wanted)>;

inline std::vector<std::string> no_names(const std::string&) { return {}; }

/// The words that may stand next on a command line, for a shell: subcommands, options, names; sorted.
/// @param words typed behind the program's name; the last is what they begin with, perhaps nothing yet
std::vector<std::string> completions(const CLI::App& app, const std::vector<std::string>& words, const NamesOf& names);

}  // namespace limb_ring::cli
