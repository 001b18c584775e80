#include "tools/common/command_line.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <iostream>
#include <memory>
#include <sstream>

#include "config/quantity.h"
#include "config/ring_config.h"
#include "tools/common/man_page.h"

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

namespace {

std::string in_quotes(const std::string& text) { return "'" + text + "'"; }

std::string range(const std::string& least, const std::string& most) { return least + " to " + most; }

std::optional<double> seconds_in(const std::string& text) {
  if (const auto plain = config::parse_real(text)) return plain;
  const auto time = config::parse_time(text);
  if (!time) return std::nullopt;
  return std::chrono::duration<double>(*time).count();
}

std::string time_text(double seconds) {
  return config::format_time(std::chrono::nanoseconds(std::llround(seconds * 1e9)));
}

std::string time_range(const std::string& least, const std::string& most) {
  return "a time, " + range(least, most) + ": 500ms, 2s, or a number of seconds";
}

/// As CLI11 reads it back, to the nanosecond.
std::string digits(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

}  // namespace

CLI::Validator whole(std::int64_t least, std::int64_t most) {
  const std::string allowed = "a whole number, " + range(std::to_string(least), std::to_string(most));
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto value = config::parse_integer(text);
        if (!value || *value < least || *value > most) return in_quotes(text) + " is not " + allowed;
        text = std::to_string(*value);
        return {};
      },
      "");
}

CLI::Validator real(double least, double most) {
  const std::string allowed = "a number, " + range(config::format_real(least), config::format_real(most));
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto value = config::parse_real(text);
        if (!value || *value < least || *value > most) return in_quotes(text) + " is not " + allowed;
        text = digits(*value);
        return {};
      },
      "");
}

CLI::Validator pace() {
  return CLI::Validator(
      [number = real(0.001, 1000)](std::string& text) -> std::string {
        const std::string wrong = text == "max" ? "" : number(text);
        if (text == "max") text = "inf";
        return wrong.empty() ? "" : wrong + ", or max";
      },
      "");
}

CLI::Validator seconds(double least, double most) {
  const std::string allowed = time_range(time_text(least), time_text(most));
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto value = seconds_in(text);
        if (!value || *value < least || *value > most) return in_quotes(text) + " is not " + allowed;
        text = digits(*value);
        return {};
      },
      "");
}

CLI::Validator nanoseconds(std::chrono::nanoseconds least, std::chrono::nanoseconds most) {
  const std::string allowed = time_range(config::format_time(least), config::format_time(most));
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto value = config::parse_time(config::parse_real(text) ? text + "s" : text);
        if (!value || *value < least || *value > most) return in_quotes(text) + " is not " + allowed;
        text = std::to_string(value->count());
        return {};
      },
      "");
}

CLI::Validator one_of(std::vector<std::string> words) {
  return CLI::Validator(
      [words = std::move(words)](std::string& text) -> std::string {
        for (const std::string& word : words)
          if (word == text) return {};
        const std::string meant = config::closest(text, words);
        return in_quotes(text) + " is unknown" + (meant.empty() ? "; " : ", did you mean '" + meant + "'? ") +
               "allowed: " + config::join(words);
      },
      "");
}

// Streams do not keep the reason: writing once more fails for the same one.
std::string finish_writing(std::ostream& out, const std::string& path) {
  if (out.flush()) return "";
  out.clear();
  errno = 0;
  out.put('\n').flush();
  return path + ": not all could be written" + (errno != 0 ? std::string(": ") + std::strerror(errno) : "");
}

int code_with_output(const std::string& program, int code) {
  if (code != 0) return code;
  const std::string problem = finish_writing(std::cout, "standard output");
  if (problem.empty()) return code;
  std::cerr << program << ": " << problem << '\n';
  return 1;
}

namespace {

std::string interrupted;  // written before the handler is there, and not any more

void end_interrupted(int) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, interrupted.data(), interrupted.size());
  ::_exit(1);
}

}  // namespace

void end_interrupted_with_one(const std::string& program) {
  interrupted = program + ": interrupted\n";
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(number, end_interrupted) == SIG_IGN) std::signal(number, SIG_IGN);
}

}  // namespace limb_ring::cli
