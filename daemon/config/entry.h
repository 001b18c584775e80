#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/config_error.h"
#include "config/ring_config.h"
#include "config/urdf_joints.h"

namespace limb_ring::config {

/// One configuration while it is being read.
struct Document {
  std::string name;                           ///< the file, for errors
  std::map<std::string, std::uint8_t> nodes;  ///< every node's id, by name and by id in digits
  UrdfJoints urdf;                            ///< what it names as `urdf`
  std::map<std::string, std::size_t> hosts;   ///< every host's place in the file, by name
  std::vector<ReadFile> files;                ///< that were read beside it
  /// Not all nodes, or hosts, could be read: who refers to one that is not there is not to blame.
  bool nodes_unsure = false, hosts_unsure = false;
  bool urdf_unsure = false;  ///< it could not be read
  /// What the URDF does not say of joints that it is asked for: their names, by what it is.
  std::map<std::string, std::vector<std::string>> not_said;
};

struct Member;

/// A value somewhere in the YAML, which knows its own place for errors: what every reader is
/// given. Lives no longer than its Document.
class Entry {
 public:
  Entry(YAML::Node node, std::string path, Document& document);

  /// "nodes[3].joints[0].lower"; empty for the whole file.
  const std::string& path() const { return path_; }
  Document& document() const { return *document_; }
  bool is_scalar() const { return node_.IsScalar(); }
  bool is_map() const { return node_.IsMap(); }
  bool is_list() const { return node_.IsSequence(); }

  /// A single value, as text. `allowed` says what would be right, in this and what follows.
  /// @throw ConfigError where it is a list, a map or nothing.
  std::string text(const std::string& allowed) const;
  /// The elements of a list, of at most `most`.
  /// @throw ConfigError where it is no list, or longer.
  std::vector<Entry> items(const std::string& allowed, std::size_t most = 1000000) const;
  /// The entries of a map, in the file's order.
  /// @throw ConfigError where it is no map, a key is no single value, or one comes twice.
  std::vector<Member> members(const std::string& allowed) const;
  /// The entry of that name in a map.
  std::optional<Entry> find(const std::string& key) const;

  /// What stands there, on one line: "{cut: [a, b]}"; what is long is cut short by "...".
  std::string in_one_line() const;

  /// @throw ConfigError `FILE:LINE:COLUMN: entry 'PATH': PROBLEM; allowed: ALLOWED`, always.
  [[noreturn]] void refuse(const std::string& problem, const std::string& allowed) const;
  /// The same as a line of `problems`.
  void note(Problems& problems, const std::string& problem, const std::string& allowed) const;
  /// The same with what stands there: `'12 parsec' PROBLEM`.
  [[noreturn]] void refuse_value(const std::string& problem, const std::string& allowed) const;

 private:
  std::string place() const;
  std::string found() const;
  std::string path_of(const std::string& key) const;

  YAML::Node node_;
  std::string path_;
  Document* document_;
};

/// `key: value`. The key's path is the value's.
struct Member {
  Entry key;
  Entry value;
  std::string name;
};

}  // namespace limb_ring::config
