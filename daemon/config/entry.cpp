#include "config/entry.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "config/quantity.h"
#include "config/ring_config.h"

namespace limb_ring::config {
namespace {

/// Named by the hash of its path (FNV-1a, 64 bits): paths are longer than names may be.
std::string place_kept(const std::string& folder, const std::string& path) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  for (const char c : std::filesystem::absolute(path).lexically_normal().string())
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  std::ostringstream name;
  name << folder << '/' << std::hex << hash << ".read";
  return name.str();
}

}  // namespace

void keep_as_read(const std::string& folder, const std::string& path, const std::string& text) {
  const std::string place = place_kept(folder, path);
  std::ofstream out(place, std::ios::binary);
  if (!out.write(text.data(), static_cast<std::streamsize>(text.size())).flush())
    throw std::runtime_error(place + ": cannot be written: " + std::strerror(errno));
}

std::optional<std::string> as_read(const std::string& path) {
  const char* folder = std::getenv(kAsRead);
  if (folder == nullptr || *folder == '\0') return std::nullopt;
  std::ifstream in(place_kept(folder, path), std::ios::binary);
  if (!in) return std::nullopt;
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

namespace {

constexpr const char* kMerge = "<<";

std::string one_line(const YAML::Node& node) {
  constexpr std::size_t kLongest = 200;
  if (node.IsScalar()) return printable(node.Scalar());
  std::string text;
  for (const auto& part : node) {
    if (!text.empty()) text += ", ";
    if (text.size() > kLongest) {
      text += "...";
      break;
    }
    text += node.IsMap() ? one_line(part.first) + ": " + one_line(part.second) : one_line(part);
  }
  return node.IsMap() ? '{' + text + '}' : '[' + text + ']';
}

}  // namespace

Entry::Entry(YAML::Node node, std::string path, Document& document)
    : node_(std::move(node)), path_(std::move(path)), document_(&document) {}

std::string Entry::text(const std::string& allowed) const {
  if (!node_.IsScalar()) refuse(found() + " stands here", allowed);
  return node_.Scalar();
}

std::vector<Entry> Entry::items(const std::string& allowed, std::size_t most) const {
  if (!node_.IsSequence()) refuse(found() + " is not a list", allowed);
  if (node_.size() > most) refuse("a list of " + std::to_string(node_.size()) + " is too long", allowed);
  std::vector<Entry> all;
  for (const auto& item : node_) all.emplace_back(item, path_ + '[' + std::to_string(all.size()) + ']', *document_);
  return all;
}

std::vector<Member> Entry::members(const std::string& allowed) const {
  if (!node_.IsMap()) refuse(found() + " is not a map (name: value)", allowed);
  std::vector<Member> all;
  std::set<std::string> names;
  for (const auto& pair : node_) {
    const std::string name = Entry(pair.first, path_of("?"), *document_).text("a plain name");
    const Entry key(pair.first, path_of(printable(name)), *document_);
    if (name == kMerge)
      key.refuse("is YAML's merge key, which is not supported",
                 "the entries themselves; an anchor and its alias (&name, *name) for a whole value");
    if (!names.insert(name).second) key.refuse("is given twice", "once");
    all.push_back({key, Entry(pair.second, key.path(), *document_), name});
  }
  return all;
}

std::optional<Entry> Entry::find(const std::string& key) const {
  if (!node_.IsMap()) return std::nullopt;
  for (const auto& pair : node_)
    if (pair.first.IsScalar() && pair.first.Scalar() == key) return Entry(pair.second, path_of(key), *document_);
  return std::nullopt;
}

std::string Entry::in_one_line() const { return one_line(node_); }

void Entry::refuse(const std::string& problem, const std::string& allowed) const {
  const std::string what = path_.empty() ? "the file" : "entry '" + path_ + "'";
  throw ConfigError(place() + ": " + what + ": " + problem + "; allowed: " + allowed);
}

void Entry::note(Problems& problems, const std::string& problem, const std::string& allowed) const {
  problems.gather([&] { refuse(problem, allowed); });
}

void Entry::refuse_value(const std::string& problem, const std::string& allowed) const {
  refuse(found() + ' ' + problem, allowed);
}

std::string Entry::place() const { return place_in(document_->name, node_.Mark()); }

std::string Entry::found() const {
  if (node_.IsScalar()) return "'" + printable(node_.Scalar()) + "'";
  if (node_.IsSequence()) return "a list";
  return node_.IsMap() ? "a map" : "nothing";
}

std::string Entry::path_of(const std::string& key) const { return path_.empty() ? key : path_ + '.' + key; }

namespace {

constexpr std::size_t kMostBytes = 1 << 20;

/// Refuses what is not one document within its limits. yaml-cpp's own way through all documents never ends where a
/// comma follows the last one: it finds a next document there and never gets beyond it.
void check(const std::string& text, const std::string& name) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  YamlLimits first(name), second(name);
  if (!parser.HandleNextDocument(first))
    throw ConfigError(name + ": holds no YAML document; allowed: one, which is a map");
  if (parser.HandleNextDocument(second))
    throw ConfigError(place_in(name, second.start()) +
                      ": what begins here is not part of the YAML document; allowed: one document, which is a map");
}

/// Its first character is '<', which no YAML of ours begins with.
bool looks_like_xml(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");  // a byte order mark, too
  return first != std::string::npos && text[first] == '<';
}

/// yaml-cpp's own words do not say what stands there: it looks like blanks.
bool is_indented_by_a_tab(const std::string& text, const YAML::Mark& mark) {
  std::istringstream in(text);
  std::string line;
  for (int i = 0; i <= mark.line; ++i)
    if (!std::getline(in, line)) return false;
  return line.substr(0, line.find_first_not_of(" \t")).find('\t') != std::string::npos;
}

}  // namespace

YAML::Node parse_yaml(const std::string& text, const std::string& name) {
  if (looks_like_xml(text))
    throw ConfigError(name + ": is XML, not YAML; if it describes a robot, 'ringctl new " + name +
                      "' writes its ring's file");
  try {
    check(text, name);
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const bool tab = is_indented_by_a_tab(text, error.mark);
    throw ConfigError(place_in(name, error.mark) + ": is not YAML: " + error.msg +
                      (tab ? "; the line is indented by a tab, allowed: blanks" : ""));
  }
}

std::string place_in(const std::string& name, const YAML::Mark& mark) {
  if (mark.is_null()) return name;
  return name + ':' + std::to_string(mark.line + 1) + ':' + std::to_string(mark.column + 1);
}

namespace {

/// Of a path from the current folder, which that is: most often it is another one than was thought.
std::string looked_in(const std::string& path) {
  std::error_code error;
  const auto folder = std::filesystem::current_path(error);
  if (error || std::filesystem::path(path).is_absolute()) return {};
  return " (looked in " + folder.string() + ")";
}

}  // namespace

// Only a regular file: reading a pipe or a device might never end.
std::string read_file(const std::string& path) {
  if (auto text = as_read(path)) return std::move(*text);
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw ConfigError(path + ": there is no such file" + looked_in(path));
  if (!std::filesystem::is_regular_file(status)) throw ConfigError(path + ": is not a file; allowed: a regular file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw ConfigError(path + ": cannot be read: " + std::strerror(errno));
  std::string text(kMostBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) throw ConfigError(path + ": cannot be read: " + std::strerror(errno));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kMostBytes) throw ConfigError(path + ": is too large; allowed: up to 1 MiB");
  return text;
}

void YamlLimits::OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) {
  const auto target = anchored_.find(anchor);
  if (target == anchored_.end()) refuse(mark, "a list or map holds itself; allowed: aliases of what has ended before");
  add(mark, YAML::NullAnchor, target->second);
}

void YamlLimits::add(const YAML::Mark& mark, YAML::anchor_t anchor, const Extent& extent) {
  if (anchor != YAML::NullAnchor) anchored_[anchor] = extent;
  if (open_.empty()) return;
  Extent& outer = open_.back().extent;
  outer.values += extent.values;
  outer.depth = std::max(outer.depth, extent.depth + 1);
  check_depth(mark, open_.size() + extent.depth);
  if (outer.values > kMostValues)
    refuse(mark,
           "too many values, each alias counted as all that it stands for; allowed: " + std::to_string(kMostValues));
}

void YamlLimits::begin(const YAML::Mark& mark, YAML::anchor_t anchor) {
  open_.push_back({mark, anchor, {1, 1}});
  check_depth(mark, open_.size());
}

void YamlLimits::end() {
  const Open closed = open_.back();
  open_.pop_back();
  add(closed.mark, closed.anchor, closed.extent);
}

void YamlLimits::check_depth(const YAML::Mark& mark, std::size_t depth) const {
  if (depth > kMostDepth)
    refuse(mark, "lists and maps are nested too deep; allowed: " + std::to_string(kMostDepth) + " levels");
}

void YamlLimits::refuse(const YAML::Mark& mark, const std::string& problem) const {
  throw ConfigError(place_in(name_, mark) + ": " + problem);
}

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
  entry.refuse_value(
      meant.empty() ? "is not a node of this ring" : "is not a node of this ring, did you mean '" + meant + "'?", rule);
}

}  // namespace limb_ring::config
