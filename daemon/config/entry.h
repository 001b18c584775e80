#pragma once

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/yaml.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/quantity.h"
#include "config/ring_config.h"
#include "config/urdf_joints.h"

namespace limb_ring::config {

/// The files of a ring as `ringctl up` has read them, kept in the ring's folder: its daemons and their CPUs read these,
/// also those that start again after a file was edited. (ours)
///
/// The environment variable that names the folder, for a daemon and what it starts.
constexpr const char* kAsRead = "LIMB_RING_AS_READ";

/// Keeps a text in a folder, in place of one of that path. @throw std::runtime_error
void keep_as_read(const std::string& folder, const std::string& path, const std::string& text);
/// What is kept of that path; nothing if nothing is, or the environment names no folder.
std::optional<std::string> as_read(const std::string& path);

/// One configuration while it is being read.
struct Document {
  std::string name;                                                 ///< the file, for errors
  std::map<std::string, std::uint8_t> nodes;                        ///< every node's id, by name and by id in digits
  UrdfJoints urdf;                                                  ///< what it names as `urdf`
  std::map<std::string, std::size_t> hosts;                         ///< every host's place in the file, by name
  std::map<std::string, std::vector<std::uint8_t>> nodes_of_hosts;  ///< in a scenario
  std::vector<ReadFile> files;                                      ///< that were read beside it
  /// Not all nodes, or hosts, could be read: a reference to a missing one is not an error then.
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
  /// @throw ConfigError if it is a list, a map or nothing.
  std::string text(const std::string& allowed) const;
  /// The elements of a list, of at most `most`.
  /// @throw ConfigError if it is not a list, or longer.
  std::vector<Entry> items(const std::string& allowed, std::size_t most = 1000000) const;
  /// The entries of a map, in the file's order.
  /// @throw ConfigError if it is not a map, a key is not a single value, or one comes twice.
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

/// The text of a configuration, as_read() if that is kept. @throw ConfigError if it is not a regular file, not
/// readable, or above 1 MiB
std::string read_file(const std::string& path);

/// @param name stands for the file in errors
/// @throw ConfigError if it is not YAML, not one document, or beyond YamlLimits
YAML::Node parse_yaml(const std::string& text, const std::string& name);

/// "FILE:LINE:COLUMN", counted from 1; FILE alone if the place is not known.
std::string place_in(const std::string& name, const YAML::Mark& mark);

/// Watches one YAML document while it is parsed, before anything is built of it, and ends the parsing if the
/// document would be too much: an alias counts as all that it stands for. (ours)
class YamlLimits final : public YAML::EventHandler {
 public:
  static constexpr std::size_t kMostDepth = 64;       ///< lists and maps within each other
  static constexpr std::size_t kMostValues = 300000;  ///< values, lists, maps and keys together

  /// @param name of the file, for errors. Every call below throws ConfigError if a limit is passed.
  explicit YamlLimits(std::string name) : name_(std::move(name)) {}

  /// Where the document begins.
  const YAML::Mark& start() const { return start_; }

  void OnDocumentStart(const YAML::Mark& mark) override { start_ = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(mark, anchor, {}); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, const std::string&) override {
    add(mark, anchor, {});
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override;
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    begin(mark, anchor);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    begin(mark, anchor);
  }
  void OnMapEnd() override { end(); }

 private:
  struct Extent {
    std::size_t values = 1;
    std::size_t depth = 0;  ///< lists and maps within each other, this one too
  };
  /// A list or map whose end is still to come.
  struct Open {
    YAML::Mark mark;
    YAML::anchor_t anchor;
    Extent extent;
  };

  void add(const YAML::Mark& mark, YAML::anchor_t anchor, const Extent& extent);
  void begin(const YAML::Mark& mark, YAML::anchor_t anchor);
  void end();
  void check_depth(const YAML::Mark& mark, std::size_t depth) const;
  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& problem) const;

  std::string name_;
  YAML::Mark start_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, Extent> anchored_;
};

/// What one option accepts; `allowed` puts it in words for errors and documentation alike.
struct IntegerRange {
  std::int64_t least, most;
};
struct RealRange {
  double least, most;
  const char* unit;
};
/// Of a joint, as far as packets carry it (payload/joint_state.h).
constexpr RealRange kPositions{-2147, 2147, "rad or m"}, kVelocities{0.001, 2147, "rad/s or m/s"},
    kEfforts{0.001, 2147, "N m or N"};
struct TimeRange {
  std::chrono::nanoseconds least, most;
  std::chrono::nanoseconds grain;  ///< whole multiples of this
};
constexpr IntegerRange kReceiveBuffers{1, 65536};
std::string allowed(const IntegerRange& range);
std::string allowed(const RealRange& range);
std::string allowed(const TimeRange& range);

extern const char* const kAllowedRates;
extern const char* const kAllowedCommands;

/// Each reads one value. @throw ConfigError if it is not what is allowed.
std::int64_t read_integer(const Entry& entry, const IntegerRange& range);
double read_real(const Entry& entry, const RealRange& range);
std::chrono::nanoseconds read_time(const Entry& entry, const TimeRange& range);
/// bit/s; 0 if `unlimited`.
std::uint64_t read_rate(const Entry& entry);
bool read_flag(const Entry& entry);
/// @return index into `words`.
std::size_t read_choice(const Entry& entry, const std::vector<std::string>& words);
std::string read_name(const Entry& entry, bool (*fits)(const std::string&), const char* rule);
/// Program and arguments: a list of 1 to 64 words, the first not empty.
std::vector<std::string> read_command(const Entry& entry);
/// An IPv4 or IPv6 address in numbers, of one interface.
std::string read_address(const Entry& entry);
/// A node of this ring, by id or name. `also`: what else the option takes, for the error.
std::uint8_t read_node(const Entry& entry, const std::string& also = "");

}  // namespace limb_ring::config
