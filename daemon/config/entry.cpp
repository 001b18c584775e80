#include "config/entry.h"

#include <set>
#include <utility>

#include "config/characters.h"
#include "config/yaml_file.h"

namespace limb_ring::config {
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
  if (!node_.IsSequence()) refuse(found() + " is no list", allowed);
  if (node_.size() > most) refuse("a list of " + std::to_string(node_.size()) + " is too long", allowed);
  std::vector<Entry> all;
  for (const auto& item : node_) all.emplace_back(item, path_ + '[' + std::to_string(all.size()) + ']', *document_);
  return all;
}

std::vector<Member> Entry::members(const std::string& allowed) const {
  if (!node_.IsMap()) refuse(found() + " is no map (name: value)", allowed);
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

}  // namespace limb_ring::config
