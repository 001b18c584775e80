#include "tools/cli/completion.h"

#include <algorithm>

#include "tools/cli/app_parts.h"

namespace limb_ring::cli {

namespace {

using Words = std::vector<std::string>;

bool is_option(const std::string& word) { return !word.empty() && word.front() == '-'; }

void add(Words& all, const Words& more) { all.insert(all.end(), more.begin(), more.end()); }

/// The subcommand that was typed, and of it, and so on.
const CLI::App& typed(const CLI::App& app, const Words& words, std::size_t from) {
  const Words known = subcommands_of(app);
  for (std::size_t i = from; i + 1 < words.size(); ++i)
    if (std::find(known.begin(), known.end(), words[i]) != known.end())
      return typed(*app.get_subcommand(words[i]), words, i + 1);
  return app;
}

/// The option before the last word, where it wants a value; null where it is none.
const CLI::Option* waiting_option(const CLI::App& app, const Words& words) {
  if (words.size() < 2 || !is_option(words[words.size() - 2])) return nullptr;
  for (const CLI::Option* option : options_of(app))
    if (option->check_name(words[words.size() - 2])) return option->get_items_expected_max() > 0 ? option : nullptr;
  return nullptr;
}

Words names_of_arguments(const CLI::App& app, const NamesOf& names) {
  Words all;
  for (const CLI::Option* option : app.get_options())
    if (option->get_positional())
      for (const std::string& wanted : {option->get_name(/*positional=*/true), option->get_type_name()})
        add(all, names(wanted));
  return all;
}

Words candidates(const CLI::App& app, const Words& words, const NamesOf& names) {
  if (const CLI::Option* option = waiting_option(app, words)) return names(option->get_name());
  if (is_option(words.back())) return option_names(app);
  Words subcommands = subcommands_of(app);
  if (subcommands.empty()) return names_of_arguments(app, names);
  if (words.size() == 1) subcommands.push_back("help");
  return subcommands;
}

}  // namespace

std::vector<std::string> completions(const CLI::App& app, const std::vector<std::string>& words, const NamesOf& names) {
  if (words.empty()) return {};
  Words all = candidates(typed(app, words, 0), words, names);
  const std::string& begun = words.back();
  const auto is_other = [&begun](const std::string& word) { return word.compare(0, begun.size(), begun) != 0; };
  all.erase(std::remove_if(all.begin(), all.end(), is_other), all.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace limb_ring::cli
