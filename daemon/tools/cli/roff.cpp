#include "tools/cli/roff.h"

#include <algorithm>
#include <cctype>

#include "tools/cli/command_line.h"

namespace limb_ring::cli {

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

}  // namespace limb_ring::cli
