#include "config/option.h"

#include <algorithm>

#include "config/ring_sections.h"

namespace limb_ring::config {

void check_names(const Entry& map, const std::vector<std::string>& allowed, const std::vector<std::string>& required) {
  const std::string rule = "a map of " + join(allowed);
  Problems problems;
  for (const Member& member : map.members(rule)) {
    if (std::find(allowed.begin(), allowed.end(), member.name) != allowed.end()) continue;
    const std::string meant = closest(member.name, allowed);
    member.key.note(problems, meant.empty() ? "is unknown" : "is unknown, did you mean '" + meant + "'?",
                    join(allowed));
  }
  for (const std::string& name : required)
    if (!map.find(name)) map.note(problems, "'" + name + "' is missing", rule);
  problems.refuse_all();
}

namespace {

const char* const kHead =
    "# Options of a ring's file\n"
    "\n"
    "<!-- Printed by `ringd --options`; do not edit by hand. -->\n"
    "\n"
    "One YAML file describes one ring. An entry that is not listed here is refused, as is a value\n"
    "that is not allowed. Times are written with their unit (`ns`, `us`, `ms`, `s`), data rates\n"
    "as `10Mbit/s` (`bit/s`, `kbit/s`, `Mbit/s`, `Gbit/s`, also `10Mbps` or `10M`; a plain number\n"
    "is bit/s). Numbers may be written `1e6` or `64k`. Angles are in rad, lengths in m.\n";

/// Bare code where it stands so in a file, plain words where it explains.
std::string cell(const std::string& fallback) {
  const bool words = fallback == kRequired || fallback.find('`') != std::string::npos ||
                     fallback.find_first_of(" ") != std::string::npos;
  return words && fallback[0] != '{' ? fallback : '`' + fallback + '`';
}

template <typename T>
std::string table(const std::string& title, const Section<T>& section) {
  std::string text = "\n## " + title + "\n\n";
  text += "| entry | default | allowed | meaning |\n|---|---|---|---|\n";
  for (const Option<T>& option : section)
    text +=
        "| `" + option.name + "` | " + cell(option.fallback) + " | " + option.allowed + " | " + option.meaning + " |\n";
  return text;
}

}  // namespace

std::string options_markdown() {
  return kHead + table("The file", ring_section()) + table("`limits`", limits_section()) +
         table("`timeouts`", timeouts_section()) + table("`links`", links_section()) +
         table("`links.expected`, `nodes[].link.expected`", expected_section()) +
         table("`firmware`", firmware_section()) + table("`realtime`", realtime_section()) +
         table("`recorder`", recorder_section()) + table("`hosts[]`", host_section()) +
         table("`nodes[]`", node_section()) + table("`nodes[].cpu`, a map", cpu_section()) +
         table("`nodes[].joints[]`", joint_section()) + table("`nodes[].sensors[]`", sensor_section()) +
         table("`nodes[].pins`", pins_section()) + table("`nodes[].inputs`", inputs_section()) +
         table("`nodes[].inputs`, each", input_section()) + table("`nodes[].link`", link_section()) +
         table("`supervisor`", supervisor_section()) + table("`virtual`", virtual_clock_section()) +
         table("`bridge`", bridge_section()) + table("`bridge.topics[]`", topic_section()) +
         table("`traffic[]`", traffic_section());
}

}  // namespace limb_ring::config
