#pragma once

#include <gmock/gmock.h>

#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tools/run_cli.h"

namespace limb_ring {

/// What a --help names: "-n" and "--count" of "  -n,--count N  At most so many", "up" of "  up  Start a ring".
struct NamedByHelp {
  explicit NamedByHelp(const std::string& help) {
    std::istringstream lines(help);
    bool behind_subcommands = false;
    for (std::string line; std::getline(lines, line);) {
      if (line.empty()) behind_subcommands = false;
      // "Subcommands:", or the title of another group of them
      if (std::regex_match(line, std::regex("[A-Z][a-z_ ]+:")))
        behind_subcommands = line != "Options:" && line != "Positionals:";
      std::smatch entry;
      if (!std::regex_search(line, entry, std::regex("^  ([^ ]+)"))) continue;
      const std::string name = entry[1];
      if (name.front() == '-')
        add_options(name);
      else if (behind_subcommands)
        subcommands.push_back(name);
    }
  }

  std::vector<std::string> options, subcommands;

 private:
  void add_options(const std::string& names) {
    std::istringstream parts(names);
    for (std::string name; std::getline(parts, name, ',');) options.push_back(name);
  }
};

/// What a program answers to a shell that has these words.
template <typename Run>
std::vector<std::string> completed(const Run& run, std::vector<std::string> words) {
  words.insert(words.begin(), "complete");
  std::istringstream answer(run(words).out);
  std::vector<std::string> all;
  for (std::string word; std::getline(answer, word);) all.push_back(word);
  return all;
}

/// Lines fit a terminal, but for one word that is longer.
inline void expect_narrow(const std::string& help) {
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(line.size() <= 80 || line.find(' ', line.find_first_not_of(' ')) == std::string::npos) << line;
}

/// A --help fits a terminal and has an example. All that it names is completed, of the program (no words), a
/// subcommand, and all theirs.
template <typename Run>
void expect_help_completed(const Run& run, const std::vector<std::string>& words = {}) {
  using ::testing::IsSupersetOf;
  const auto with = [&words](const std::string& word) {
    std::vector<std::string> all = words;
    all.push_back(word);
    return all;
  };
  const std::string help = run(with("--help")).out;
  EXPECT_THAT(help, ::testing::HasSubstr("\nExample: ")) << ::testing::PrintToString(words);
  expect_narrow(help);
  const NamedByHelp named(help);
  ASSERT_FALSE(named.options.empty());
  EXPECT_THAT(completed(run, with("-")), IsSupersetOf(named.options)) << ::testing::PrintToString(words);
  EXPECT_THAT(completed(run, with("")), IsSupersetOf(named.subcommands)) << ::testing::PrintToString(words);
  for (const std::string& subcommand : named.subcommands) expect_help_completed(run, with(subcommand));
}

}  // namespace limb_ring
