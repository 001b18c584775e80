#include "tools/cli/command_line.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <sstream>

#include "config/names.h"
#include "tools/cli/app_parts.h"
#include "tools/cli/man_page.h"

namespace limb_ring::cli {

namespace {

constexpr int kDone = 0, kWrong = 2;
constexpr std::size_t kColumns = 80;
constexpr std::size_t kColumn = 24;  // where the description of an option begins

using Words = std::vector<std::string>;

/// The subcommand that was given, and of it, and so on.
const CLI::App& deepest(const CLI::App& app) {
  for (const CLI::App* part : app.get_subcommands())
    if (!part->get_name().empty()) return deepest(*part);
  return app;
}

/// "ringctl fault cut"
std::string full_name(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name() : full_name(*app.get_parent()) + ' ' + app.get_name();
}

std::string see_help(const CLI::App& app) { return "'" + full_name(app) + " --help' says more"; }

std::string guess(const std::string& word, const Words& known) {
  const std::string meant = config::closest(word, known);
  return meant.empty() ? ". " : ", did you mean '" + meant + "'? ";
}

[[noreturn]] void no_such_subcommand(const CLI::App& app, const std::string& word) {
  const Words known = subcommands_of(app);
  const std::string meant = guess(word, known);
  throw WrongCommandLine("'" + full_name(app) + " " + word + "' is unknown" + meant +
                         "There are: " + config::join(known));
}

[[noreturn]] void one_too_many(const CLI::App& app, const std::string& word) {
  if (word.size() < 2 || word[0] != '-')
    throw WrongCommandLine("'" + word + "' is one argument too many; " + see_help(app));
  const std::string name = word.substr(0, word.find('='));
  const Words known = option_names(app);
  if (std::find(known.begin(), known.end(), name) != known.end())
    throw WrongCommandLine(name + " belongs behind the subcommand: " + full_name(app) + ' ' + name);
  throw WrongCommandLine("there is no option " + name + guess(name, known) + see_help(app));
}

/// What was left over, nobody's option or argument.
void check_left_over(const CLI::App& root) {
  const CLI::App& app = deepest(root);
  Words left = root.remaining(/*recurse=*/true);
  left.erase(std::remove(left.begin(), left.end(), "--"), left.end());  // left there where something else is wrong
  const auto word = std::find_if(left.begin(), left.end(), [](const std::string& text) { return text[0] != '-'; });
  if (!subcommands_of(app).empty() && word != left.end()) no_such_subcommand(app, *word);
  if (!left.empty()) one_too_many(app, left.front());
}

std::string name_in(const std::string& message) { return message.substr(0, message.find(':')); }

[[noreturn]] void wrong_number_of_values(const CLI::App& app, const std::string& message) {
  const std::string name = name_in(message);
  if (message.find("received") != std::string::npos) throw WrongCommandLine(name + " is given more than once");
  for (const CLI::Option* option : options_of(app))
    if (option->check_name(name)) throw WrongCommandLine(name + " needs a value: " + option->get_description());
  throw WrongCommandLine(message + "; " + see_help(app));
}

/// As the usage line names it: "TO", not "--to", of an option that may stand alone. A group of options is named as
/// CLI11 does.
[[noreturn]] void one_is_missing(const CLI::App& app, const std::string& message) {
  const std::string first = message.substr(0, message.find(' '));
  for (const CLI::Option* option : options_of(app)) {
    if (!option->check_name(first)) continue;
    const std::string alone = option->get_name(/*positional=*/true);
    throw WrongCommandLine((alone.empty() ? first : alone) + " is required; " + see_help(app));
  }
  throw WrongCommandLine(message + "; " + see_help(app));
}

[[noreturn]] void explain(const CLI::App& root, const CLI::ParseError& error) {
  const CLI::App& app = deepest(root);
  check_left_over(root);
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) wrong_number_of_values(app, error.what());
  const bool required = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  if (required && !subcommands_of(app).empty())
    throw WrongCommandLine("'" + full_name(app) + "' needs one of: " + config::join(subcommands_of(app)) + "; " +
                           see_help(app));
  if (required) one_is_missing(app, error.what());
  throw WrongCommandLine(error.what());
}

/// An empty word is what a shell makes of a variable that is not set: taken for an option that is not given, the
/// program would do something else than was asked for.
void check_not_empty(const CLI::App& root) {
  const CLI::App& app = deepest(root);
  for (const CLI::Option* option : options_of(app)) {
    const auto& words = option->results();
    if (std::none_of(words.begin(), words.end(), [](const std::string& word) { return word.empty(); })) continue;
    const std::string alone = option->get_name(/*positional=*/true);
    throw WrongCommandLine((alone.empty() ? option->get_name() : alone) + " is empty: " + option->get_description());
  }
}

/// `help status` is `status --help`.
void take_help_for_a_word(Words& arguments) {
  if (arguments.empty() || arguments[0] != "help") return;
  arguments.erase(arguments.begin());
  arguments.push_back("--help");
}

std::string lines(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += word + '\n';
  return text;
}

/// What roslaunch adds at the end for ROS nodes, which our programs are not: FROM:=TO of each <remap> in scope,
/// `__name:=...` and `__log:=...`.
void drop_words_of_roslaunch(Words& words) {
  const auto is_for_nodes = [](const std::string& word) { return word.find(":=") != std::string::npos; };
  const auto is_name = [](const std::string& word) { return word.rfind("__name:=", 0) == 0; };
  const auto added = std::find_if_not(words.rbegin(), words.rend(), is_for_nodes).base();
  if (std::any_of(added, words.end(), is_name)) words.erase(added, words.end());
}

void set_formatter(CLI::App& app, const std::shared_ptr<CLI::Formatter>& formatter) {
  app.formatter(formatter);
  for (CLI::App* part : app.get_subcommands([](CLI::App*) { return true; })) set_formatter(*part, formatter);
}

/// Where what is left of a line goes on: below the description of an option, or deeper than the line began.
std::size_t hanging(const std::string& line) {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  if (begin == 0 || begin >= kColumn) return begin;
  const std::size_t gap = line.find("  ", begin);
  const std::size_t behind = gap == std::string::npos ? gap : line.find_first_not_of(' ', gap);
  return behind == kColumn ? kColumn : begin + 2;
}

/// The line in lines of at most kColumns, broken between words. What is longer than that alone stays whole.
std::string fitted_line(std::string line) {
  const std::string margin(hanging(line), ' ');
  std::string text;
  while (line.size() > kColumns) {
    std::size_t at = line.rfind(' ', kColumns);
    if (at == std::string::npos || at <= margin.size()) at = line.find(' ', kColumns);
    if (at == std::string::npos) break;
    text += line.substr(0, line.find_last_not_of(' ', at) + 1) + '\n';
    line = margin + line.substr(at + 1);
  }
  return text + line;
}

/// A terminal's 80 columns, also in a file: the page of commands is the same everywhere.
std::string fitted(const std::string& help) {
  std::istringstream lines(help);
  std::string text;
  for (std::string line; std::getline(lines, line);) text += fitted_line(line) + '\n';
  return text;
}

/// How --help calls what an option takes.
void label(CLI::App& app) {
  auto formatter = std::make_shared<CLI::Formatter>();
  formatter->column_width(kColumn);
  for (const char* number : {"UINT", "INT", "FLOAT"}) formatter->label(number, "N");
  formatter->label("ENUM", "WORD");
  formatter->label("REQUIRED", "(required)");
  set_formatter(app, formatter);
}

}  // namespace

const char* version() { return LIMB_RING_VERSION; }

std::string footer(const std::string& more, const std::string& example, const std::string& exit_codes) {
  std::string text = more.empty() || more.back() == '\n' ? more : more + '\n';
  if (!example.empty()) text += "Example: " + example + '\n';
  return text + exit_codes;
}

std::optional<std::string> read(CLI::App& app, Words arguments, const NamesOf& names) {
  drop_words_of_roslaunch(arguments);
  if (app.get_option_no_throw("--version") == nullptr) app.add_flag("--version", "Print the version and end");
  if (!arguments.empty() && arguments[0] == "complete")
    return lines(completions(app, {arguments.begin() + 1, arguments.end()}, names));
  if (!arguments.empty() && (arguments[0] == "--version" || arguments[0] == "version"))
    return app.get_name() + ' ' + version() + '\n';
  take_help_for_a_word(arguments);
  label(app);
  if (!arguments.empty() && arguments[0] == "man-page") return man_page(app);
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the end
  try {
    app.parse(arguments);
  } catch (const CLI::CallForHelp&) {
    check_left_over(app);
    return fitted(app.help());
  } catch (const CLI::ParseError& error) {
    explain(app, error);
  }
  check_not_empty(app);
  if (app.count("--version") != 0) return app.get_name() + ' ' + version() + '\n';
  return std::nullopt;
}

std::optional<int> parse(CLI::App& app, int argc, const char* const* argv, const NamesOf& names) {
  try {
    const auto asked = read(app, Words(argv + 1, argv + std::max(argc, 1)), names);
    if (!asked) return std::nullopt;
    std::cout << *asked;
    return kDone;
  } catch (const WrongCommandLine& wrong) {
    std::cerr << app.get_name() << ": " << wrong.what() << '\n';
    return kWrong;
  }
}

}  // namespace limb_ring::cli
