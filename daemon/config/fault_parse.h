#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "config/fault.h"

namespace limb_ring::config {
struct RingConfig;
struct NodeConfig;
}  // namespace limb_ring::config

namespace limb_ring::fault {

/// A node as people speak of it, and as a Fault does.
struct NamedNode {
  std::string name;
  std::string number;  ///< its id in digits
  NodeId id{0};
  std::string host = {};  ///< its name, which stands for all nodes of it; empty: nobody has said
};
/// All nodes of a ring, in ring order.
using RingNodes = std::vector<NamedNode>;
/// Empty where the file gives no hosts.
std::string host_name(const config::RingConfig& ring, const config::NodeConfig& node);
/// Those of a configured ring; a Fault names them by their configured ids.
RingNodes nodes_by_id(const config::RingConfig& ring);

/// A word as an error message shows it: on one line, and of a long one the first 60 bytes.
std::string shown(const std::string& word);

/// A text that is not a fault. what() reads `PROBLEM; allowed: ALLOWED`.
struct ParseError : std::runtime_error {
  ParseError(const std::string& why, const std::string& right)
      : std::runtime_error(why + "; allowed: " + right), problem(why), allowed(right) {}
  std::string problem, allowed;
};

/// A word too many: it does not say where the fault is, and has no key before it, such as `1Mbit/s` for
/// `rate=1Mbit/s`.
struct BareWord : ParseError {
  BareWord(std::string bare, std::string meant, const std::string& right)
      : ParseError('\'' + bare + "' is a word too many", right), word(std::move(bare)), key(std::move(meant)) {}
  std::string word;
  std::string key;  ///< a key of the fault that takes such a value; empty if none does
};

/// A parameter that the fault needs is missing, such as how often a line flaps.
struct MissingKey : ParseError {
  MissingKey(std::string word, std::vector<std::string> any_of, const std::string& right);
  std::string fault;
  std::vector<std::string> keys;  ///< any of them is enough
};

/// The one form of a fault as text, the same in tools, services and scenarios: its word, the line or nodes that it
/// hits, then its parameters.
///
///   drop left_hip -> left_hip_yaw packets=3 once_in=10 for=2s seed=4
///   drop left_hip:left_hip_yaw                             (the same line; '>' is the shell's)
///   delay body -> head delay=2ms jitter=500us
///   cut left_hip_yaw -> left_hip                           (the second line of a ring that folds back)
///   cut left_hip -> left_hip_yaw after_packets=100 of=left_knee
///   hang left_knee for=1s            kill left_knee right_knee            power_cycle all
///
/// Times have a unit (ns, us, ms, s), rates too (kbit/s, Mbit/s ...). @throw ParseError
Fault from_words(const std::string& text, const RingNodes& nodes);
/// The same form back: from_words() of the result is the same fault. @throw ParseError if it names an unknown node
std::string to_words(const Fault& fault, const RingNodes& nodes);

/// A parameter of a fault, as help and errors show it.
struct KeyWord {
  Key key;
  const char* word;
  const char* allowed;
  const char* meaning;
};
std::vector<KeyWord> keys_of(const Word& word);
/// The parameters of which one must be given; empty if the fault needs none.
std::vector<KeyWord> needed_keys_of(const Word& word);
/// One `key=value` into the fault. @throw ParseError
void set_key(Fault& fault, const std::string& key, const std::string& value, const RingNodes& nodes);
/// Its nodes: one or several, by their names or their host's, or `all`. @throw ParseError
void set_nodes(Fault& fault, const std::vector<std::string>& names, const RingNodes& nodes);
/// Its line: from a node to the next one in the ring, or, for the second line, to the one before it. @throw ParseError
void set_line(Fault& fault, const std::string& before, const std::string& behind, const RingNodes& nodes);
/// A fault of the second line needs a ring that folds back. @throw ParseError if it does not
void check_second_line(const Fault& fault, bool folds_back, const RingNodes& nodes);
/// Checks that all that the fault needs is given. @throw ParseError
void check(const Fault& fault);

}  // namespace limb_ring::fault
