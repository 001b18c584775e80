#include "config/value_readers.h"

#include "config/address.h"
#include "config/names.h"
#include "config/quantity.h"

namespace limb_ring::config {

using std::chrono::nanoseconds;

const char* const kAllowedRates = "a rate such as 10Mbit/s, 1kbit/s to 100Gbit/s, or unlimited";
const char* const kAllowedCommands = "a list of program and arguments, such as [limb_firmware]";

std::string allowed(const IntegerRange& range) {
  return "a whole number, " + std::to_string(range.least) + " to " + std::to_string(range.most);
}

std::string allowed(const RealRange& range) {
  return "a number, " + format_real(range.least) + " to " + format_real(range.most) + ' ' + range.unit;
}

std::string allowed(const TimeRange& range) {
  const char* example = range.grain < std::chrono::milliseconds(1) ? "50us" : "100ms";
  return std::string("a time such as ") + example + ", " + format_time(range.least) + " to " + format_time(range.most);
}

std::int64_t read_integer(const Entry& entry, const IntegerRange& range) {
  const auto value = parse_integer(entry.text(allowed(range)));
  if (!value) entry.refuse_value("is not a whole number", allowed(range));
  if (*value < range.least || *value > range.most) entry.refuse_value("is out of range", allowed(range));
  return *value;
}

double read_real(const Entry& entry, const RealRange& range) {
  const auto value = parse_real(entry.text(allowed(range)));
  if (!value) entry.refuse_value("is not a number", allowed(range));
  if (*value < range.least || *value > range.most) entry.refuse_value("is out of range", allowed(range));
  return *value;
}

nanoseconds read_time(const Entry& entry, const TimeRange& range) {
  const std::string text = entry.text(allowed(range));
  const auto value = parse_time(text);
  if (!value && parse_real(text)) entry.refuse_value("has no unit (ns, us, ms or s)", allowed(range));
  if (!value) entry.refuse_value("is not a time", allowed(range));
  if (*value < range.least || *value > range.most) entry.refuse_value("is out of range", allowed(range));
  if (*value % range.grain != nanoseconds::zero())
    entry.refuse_value("is too fine", allowed(range) + ", in steps of " + format_time(range.grain));
  return *value;
}

std::uint64_t read_rate(const Entry& entry) {
  const std::string text = entry.text(kAllowedRates);
  const auto value = parse_rate(text);
  if (!value) entry.refuse_value("is not a rate", kAllowedRates);
  if (text != "unlimited" && (*value < 1000 || *value > 100000000000))
    entry.refuse_value("is out of range", kAllowedRates);
  return *value;
}

bool read_flag(const Entry& entry) { return read_choice(entry, {"false", "true"}) == 1; }

std::size_t read_choice(const Entry& entry, const std::vector<std::string>& words) {
  const std::string text = entry.text(join(words));
  for (std::size_t i = 0; i < words.size(); ++i)
    if (text == words[i]) return i;
  const std::string meant = closest(text, words);
  entry.refuse_value(meant.empty() ? "is unknown" : "is unknown, did you mean '" + meant + "'?", join(words));
}

std::string read_name(const Entry& entry, bool (*fits)(const std::string&), const char* rule) {
  const std::string name = entry.text(rule);
  if (!fits(name)) entry.refuse_value("is not a name that can be used here", rule);
  return name;
}

std::vector<std::string> read_command(const Entry& entry) {
  std::vector<std::string> words;
  for (const Entry& item : entry.items(kAllowedCommands, 64)) words.push_back(item.text(kAllowedCommands));
  if (words.empty() || words[0].empty()) entry.refuse("names no program", kAllowedCommands);
  return words;
}

std::string read_address(const Entry& entry) {
  const char* rule = "the address of one interface, such as 127.0.0.1, 192.168.0.2 or ::1";
  const std::string text = entry.text(rule);
  if (!is_address(text)) entry.refuse_value("is not an address in numbers", rule);
  if (is_any_interface(text)) entry.refuse_value("is not one interface", rule);
  return text;
}

std::uint8_t read_node(const Entry& entry, const std::string& also) {
  std::vector<std::string> names;
  for (const auto& [name, id] : entry.document().nodes)
    if (is_node_name(name)) names.push_back(name);
  const std::string rule = "id or name of a node of this ring (" + join(names) + ')' + also;
  const auto& nodes = entry.document().nodes;
  const std::string text = entry.text(rule);
  const auto found = nodes.find(text);
  if (found != nodes.end()) return found->second;
  if (entry.document().nodes_unsure) throw ConfigError("");
  const std::string meant = closest(text, names);
  entry.refuse_value(meant.empty() ? "is no node of it" : "is no node of it, did you mean '" + meant + "'?", rule);
}

}  // namespace limb_ring::config
