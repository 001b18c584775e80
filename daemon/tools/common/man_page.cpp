#include "tools/common/man_page.h"

#include <algorithm>
#include <cctype>
#include <memory>

#include "tools/common/command_line.h"

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

namespace {

struct FileEntry {
  const char* path;
  const char* what;
};

constexpr FileEntry kFiles[] = {
    {"$XDG_RUNTIME_DIR/limb_ring/RING/",
     "Sockets and locks of a ring that runs, and the logs of its daemons. Where the variable is not set, or no "
     "absolute path: limb_ring-UID/RING/ in the temporary folder."},
    {"~/.config/limb_ring/RING.yaml",
     "A ring of yours, which 'ringctl up RING' finds by its name ($XDG_CONFIG_HOME where that is set)."},
    {"/etc/limb_ring/RING.yaml", "A ring for all users of this machine."},
    {"PREFIX/share/limb_ring/", "What came with limb_ring: config/ with rings, scenarios/, examples/."},
};

constexpr const char* kPrograms[] = {"limb_firmware", "ring_bridge", "ring_sim", "ringctl", "ringd"};

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

/// "Starts rings. And more" -> "starts rings", as NAME has it.
std::string as_a_name_has_it(std::string text) {
  text = text.substr(0, text.find('\n'));
  text = text.substr(0, text.find(". "));
  if (!text.empty() && text.back() == '.') text.pop_back();
  if (!text.empty()) text.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(text.front())));
  return text;
}

}  // namespace

std::string roff(const std::string& text) {
  std::string safe;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && c == '.') safe += "\\&";
    line_begins = c == '\n';
    if (c == '\\')
      safe += "\\e";
    else if (c == '-')
      safe += "\\-";
    else if (c == '\'')
      safe += "\\(aq";
    else if (c == '~')
      safe += "\\(ti";
    else if (c == '^')
      safe += "\\(ha";
    else
      safe += c;
  }
  return safe;
}

std::string man_page_begin(const std::string& name, const std::string& what, const std::string& usage) {
  return ".TH " + upper(name) + " 1 \"\" \"limb_ring " + version() + "\" \"limb_ring\"\n.SH NAME\n" + name + " \\- " +
         roff(as_a_name_has_it(what)) + "\n.SH SYNOPSIS\n.B " + name + "\n" + roff(usage) + "\n";
}

std::string man_page_end(const std::string& name) {
  std::string page = ".SH FILES\n";
  for (const FileEntry& file : kFiles)
    page += std::string(".TP\n.I ") + roff(file.path) + "\n" + roff(file.what) + "\n";
  page += ".SH SEE ALSO\n";
  std::string others;
  for (const char* other : kPrograms)
    if (name != other) others += (others.empty() ? ".BR " : ",\n.BR ") + std::string(other) + " (1)";
  return page + others + "\n";
}

std::string man_page_of_text(const std::string& name, const std::string& help, const std::string& usage) {
  const std::size_t begin = help.rfind(name + ": ", 0) == 0 ? name.size() + 2 : 0;
  const std::size_t exit_codes = std::min(help.find("Exit codes: "), help.size());
  std::string page = man_page_begin(name, help.substr(begin), usage);
  page += ".SH DESCRIPTION\n.nf\n" + roff(help.substr(0, exit_codes)) + ".fi\n";
  if (exit_codes < help.size()) page += ".SH EXIT STATUS\n" + roff(help.substr(exit_codes + 12));
  return page + man_page_end(name);
}

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

/// The option before the last word, where it wants a value; null if it is none.
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
