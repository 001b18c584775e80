#include "tools/cli/man_page.h"

#include <algorithm>
#include <memory>

#include "tools/cli/app_parts.h"
#include "tools/cli/roff.h"

namespace limb_ring::cli {

namespace {

// Where a text of --help begins to tell them.
constexpr const char *kExitCode = "Exit code: ", *kExitCodes = "Exit codes: ";

struct Text {
  std::string description, exit_status;
};

/// CLI11 hands a footer on to subcommands.
bool has_own_footer(const CLI::App& app) {
  if (app.get_parent() != nullptr && app.get_parent()->get_footer() == app.get_footer()) return false;
  return !app.get_footer().empty();
}

/// Description and footer, parted into what goes where.
Text text_of(const CLI::App& app) {
  std::string all = app.get_description() + "\n";
  if (has_own_footer(app)) all += ".PP\n" + app.get_footer() + "\n";
  const std::size_t at = std::min(all.find(kExitCode), all.find(kExitCodes));
  if (at == std::string::npos) return {all, {}};
  return {all.substr(0, at), all.substr(all.find(": ", at) + 2)};
}

/// roff(), but for the line that begins a paragraph.
std::string paragraphs(const std::string& text) {
  const std::string mark = ".PP\n";
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) return roff(text);
  const std::string rest = text.substr(at + mark.size());
  return roff(text.substr(0, at)) + (rest.empty() ? "" : mark + roff(rest));
}

bool is_positional(const CLI::Option& option) { return option.get_positional() && option.nonpositional() == false; }

/// "CONFIG", "[NODE...]"
std::string argument(const CLI::Option& option) {
  std::string name = option.get_name(/*positional=*/true);
  if (option.get_items_expected_max() > 1) name += "...";
  return option.get_required() ? name : "[" + name + "]";
}

std::string usage(const CLI::App& app) {
  std::string text = "[OPTIONS]";
  for (const CLI::Option* option : own_options_of(app))
    if (is_positional(*option)) text += " " + argument(*option);
  return subcommands_of(app).empty() ? text : text + " SUBCOMMAND ...";
}

/// What it takes, as --help has it: " N (required)".
std::string takes(const CLI::App& app, const CLI::Option& option) {
  const auto formatter = std::dynamic_pointer_cast<CLI::Formatter>(app.get_formatter());
  return formatter ? formatter->make_option_opts(&option) : std::string();
}

std::string option_entry(const CLI::App& app, const CLI::Option& option) {
  const std::string name =
      option.get_name(/*positional=*/is_positional(option), /*all_options=*/!is_positional(option));
  return ".TP\n\\fB" + roff(name) + "\\fR" + roff(takes(app, option)) + "\n" + roff(option.get_description()) + "\n";
}

/// @param help that option, too: each subcommand has it, and says so once, at the top
std::string options(const CLI::App& app, bool help) {
  std::string text;
  for (const CLI::Option* option : own_options_of(app))
    if (help || !option->check_name("--help")) text += option_entry(app, *option);
  return text;
}

std::string subcommands(const CLI::App& app, const std::string& above) {
  std::string text;
  for (const CLI::App* part : subcommand_apps_of(app)) {
    const std::string name = above + " " + part->get_name();
    text += ".SS " + roff(name + " " + usage(*part)) + "\n" + paragraphs(text_of(*part).description) +
            options(*part, false) + subcommands(*part, name);
  }
  return text;
}

}  // namespace

std::string man_page(const CLI::App& app) {
  const Text text = text_of(app);
  const std::string& name = app.get_name();
  std::string page = man_page_begin(name, app.get_description(), usage(app));
  page += ".SH DESCRIPTION\n" + paragraphs(text.description) + ".SH OPTIONS\n" + options(app, true);
  if (!subcommands_of(app).empty()) page += ".SH SUBCOMMANDS\n" + subcommands(app, name);
  if (!text.exit_status.empty()) page += ".SH EXIT STATUS\n" + roff(text.exit_status);
  return page + man_page_end(name);
}

}  // namespace limb_ring::cli
