#include "config/fault_parse.h"

#include <algorithm>
#include <optional>
#include <set>
#include <sstream>

#include "config/quantity.h"
#include "config/ring_config.h"

namespace limb_ring::fault {

namespace {

constexpr std::int64_t kMostPackets = 1000000;
constexpr nanoseconds kLongest = std::chrono::hours(1);

std::optional<std::uint64_t> whole(const std::string& text, std::int64_t most) {
  const auto value = config::parse_integer(text);
  if (!value || *value < 1 || *value > most) return std::nullopt;
  return static_cast<std::uint64_t>(*value);
}
std::optional<nanoseconds> time(const std::string& text) {
  const auto value = config::parse_time(text);
  return value && value->count() > 0 && *value <= kLongest ? value : std::nullopt;
}
std::optional<std::uint64_t> rate(const std::string& text) {
  const auto value = config::parse_rate(text);
  return value && *value >= 1000 && *value <= 100000000000 ? value : std::nullopt;
}

constexpr const char* kCount = "a whole number, 1 to 1000000";
constexpr const char* kTime = "a time such as 5ms or 200us, up to 3600s";
constexpr const char* kRateRule = "a rate such as 10Mbit/s, 1kbit/s to 100Gbit/s";

/// One row for each key: how it is read and written. `of` goes with `after_packets` and is not here.
struct Row {
  KeyWord key;
  bool (*read)(Fault&, const std::string&);
  std::string (*write)(const Fault&);  ///< empty if it has its default
};

template <std::uint64_t Fault::*member>
bool read_count(Fault& fault, const std::string& text) {
  const auto value = whole(text, kMostPackets);
  if (value) fault.*member = *value;
  return value.has_value();
}
template <nanoseconds Fault::*member>
bool read_time(Fault& fault, const std::string& text) {
  const auto value = time(text);
  if (value) fault.*member = *value;
  return value.has_value();
}
bool read_rate(Fault& fault, const std::string& text) {
  const auto value = rate(text);
  if (value) fault.rate = *value;
  return value.has_value();
}
bool read_seed(Fault& fault, const std::string& text) {
  const auto value = whole(text, INT64_MAX);
  if (value) fault.seed = *value;
  return value.has_value();
}

template <std::uint64_t Fault::*member>
std::string write_count(const Fault& fault) {
  return fault.*member == Fault{}.*member ? "" : std::to_string(fault.*member);
}
template <nanoseconds Fault::*member>
std::string write_time(const Fault& fault) {
  return (fault.*member).count() == 0 ? "" : config::format_time(fault.*member);
}
std::string write_rate(const Fault& fault) { return fault.rate == 0 ? "" : config::format_rate(fault.rate); }

const Row kRows[] = {
    {{kPackets, "packets", kCount, "ends after this number of packets"},
     read_count<&Fault::packets>,
     write_count<&Fault::packets>},
    {{kOnceIn, "once_in", kCount, "affects each packet with a probability of 1 in this number"},
     read_count<&Fault::once_in>,
     write_count<&Fault::once_in>},
    {{kDelay, "delay", kTime, "each packet arrives this much later"},
     read_time<&Fault::delay>,
     write_time<&Fault::delay>},
    {{kJitter, "jitter", kTime, "each packet arrives later by a random time, at most this"},
     read_time<&Fault::jitter>,
     write_time<&Fault::jitter>},
    {{kRate, "rate", kRateRule, "the data rate"}, read_rate, write_rate},
    {{kEvery, "every", kTime, "the length of a period"}, read_time<&Fault::every>, write_time<&Fault::every>},
    {{kFor, "for", kTime, "ends by itself after this time"}, read_time<&Fault::lasts>, write_time<&Fault::lasts>},
    {{kAfter, "after", kTime, "starts after this time"}, read_time<&Fault::after>, write_time<&Fault::after>},
    {{kAfterPackets, "after_packets", kCount,
      "starts after this number of data packets from the node `of` have passed the line"},
     read_count<&Fault::after_packets>,
     write_count<&Fault::after_packets>},
    {{kSeed, "seed", "a whole number, 1 or more", "of the random choices; by default one is drawn and printed"},
     read_seed,
     write_count<&Fault::seed>},
    {{kForward, "forward", kTime, "sets the wall clock forward by this time"},
     read_time<&Fault::forward>,
     write_time<&Fault::forward>},
    {{kBack, "back", kTime, "sets the wall clock back by this time"},
     read_time<&Fault::back>,
     write_time<&Fault::back>},
    {{kMonotonic, "monotonic", kTime, "the monotonic clock skips this time: all deadlines within it are due at once"},
     read_time<&Fault::monotonic>,
     write_time<&Fault::monotonic>},
};
constexpr const char* kOf = "of";

bool is_given(const Fault& fault, Key key) {
  return std::any_of(std::begin(kRows), std::end(kRows),
                     [&](const Row& row) { return row.key.key == key && !row.write(fault).empty(); });
}

std::vector<std::string> key_words(const Word& word) {
  std::vector<std::string> names;
  for (const KeyWord& key : keys_of(word)) names.emplace_back(key.word);
  return names;
}

std::string quoted(const std::string& word, const std::string& problem) { return '\'' + word + "' " + problem; }

std::string with_guess(const std::string& problem, const std::string& word, const std::vector<std::string>& known) {
  const std::string meant = config::closest(word, known);
  return quoted(shown(word), meant.empty() ? problem : problem + ", did you mean '" + meant + "'?");
}

std::size_t place_of(const std::string& name, const RingNodes& nodes) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].name == name || nodes[i].number == name) return i;
    names.push_back(nodes[i].name);
  }
  throw ParseError(with_guess("is not a node of the ring", name, names), config::join(names));
}

bool is_node(const std::string& name, const RingNodes& nodes) {
  return std::any_of(nodes.begin(), nodes.end(),
                     [&](const NamedNode& node) { return node.name == name || node.number == name; });
}

/// One of them, or all of a host. @throw ParseError if nothing is called so
std::vector<NodeId> nodes_called(const std::string& name, const RingNodes& nodes) {
  std::vector<NodeId> called;
  if (!is_node(name, nodes))
    for (const NamedNode& node : nodes)
      if (node.host == name) called.push_back(node.id);
  if (called.empty()) called.push_back(nodes[place_of(name, nodes)].id);
  return called;
}

/// The first key of the fault that takes such a value; empty if none does.
std::string key_taking(const std::string& value, const Word& word) {
  Fault scratch;
  for (const Row& row : kRows)
    if ((word.keys & row.key.key) != 0 && row.read(scratch, value)) return row.key.word;
  return {};
}

/// The node's name. @throw ParseError
const std::string& name_of(NodeId id, const RingNodes& nodes) {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [&](const NamedNode& node) { return node.id == id; });
  if (found == nodes.end())
    throw ParseError("node " + std::to_string(id) + " is not in the ring", "a node of the ring");
  return found->name;
}

/// Place of the node that the line out of the one at `place` leads to.
std::size_t end_of_line(std::size_t place, bool second, const RingNodes& nodes) {
  return (place + (second ? nodes.size() - 1 : 1)) % nodes.size();
}

const Word& read_word(const std::string& text) {
  if (const Word* word = find_word(text)) return *word;
  throw ParseError(text.empty() ? "no fault is named" : with_guess("is not a fault", text, words()),
                   config::join(words()));
}

std::vector<std::string> split(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

std::string needs(const Word& word, const std::string& what) { return std::string(word.word) + " needs " + what; }

}  // namespace

std::string shown(const std::string& word) { return config::printable(word); }

MissingKey::MissingKey(std::string word, std::vector<std::string> any_of, const std::string& right)
    : ParseError(word + " needs " + config::join(any_of, " or "), right),
      fault(std::move(word)),
      keys(std::move(any_of)) {}

std::string host_name(const config::RingConfig& ring, const config::NodeConfig& node) {
  const config::HostConfig* host = ring.host_of(node);
  return host == nullptr ? "" : host->name;
}

RingNodes nodes_by_id(const config::RingConfig& ring) {
  RingNodes nodes;
  for (const auto& node : ring.nodes)
    nodes.push_back({node.name, std::to_string(node.id), NodeId{node.id}, host_name(ring, node)});
  return nodes;
}

std::vector<KeyWord> keys_of(const Word& word) {
  std::vector<KeyWord> keys;
  for (const Row& row : kRows) {
    if ((word.keys & row.key.key) == 0) continue;
    keys.push_back(row.key);
    if (row.key.key == kAfterPackets)
      keys.push_back({kAfterPackets, kOf, "a node of the ring", "whose data packets are counted"});
  }
  return keys;
}

std::vector<KeyWord> needed_keys_of(const Word& word) {
  std::vector<KeyWord> needed;
  for (const Row& row : kRows)
    if ((word.needs & row.key.key) != 0) needed.push_back(row.key);
  return needed;
}

void set_key(Fault& fault, const std::string& key, const std::string& value, const RingNodes& nodes) {
  const Word& word = word_of(fault.name);
  if (key == kOf && (word.keys & kAfterPackets) != 0) {
    fault.of = nodes[place_of(value, nodes)].id;
    return;
  }
  const auto row = std::find_if(std::begin(kRows), std::end(kRows),
                                [&](const Row& r) { return key == r.key.word && (word.keys & r.key.key) != 0; });
  const std::vector<std::string> known = key_words(word);
  if (row == std::end(kRows))
    throw ParseError(with_guess(std::string("is not a parameter of ") + word.word, key, known),
                     known.empty() ? "nothing" : config::join(known));
  if (!row->read(fault, value))
    throw ParseError(quoted(shown(value), "is not allowed for '" + key + "'"), row->key.allowed);
}

void set_nodes(Fault& fault, const std::vector<std::string>& names, const RingNodes& nodes) {
  fault.nodes.clear();
  if (names.size() == 1 && names[0] == "all") {
    for (const NamedNode& node : nodes) fault.nodes.push_back(node.id);
    return;
  }
  for (const std::string& name : names)
    for (const NodeId id : nodes_called(name, nodes)) {
      if (std::find(fault.nodes.begin(), fault.nodes.end(), id) != fault.nodes.end())
        throw ParseError(quoted(name_of(id, nodes), "is named twice"), "each node once");
      fault.nodes.push_back(id);
    }
}

void set_line(Fault& fault, const std::string& before, const std::string& behind, const RingNodes& nodes) {
  const std::size_t from = place_of(before, nodes), to = place_of(behind, nodes);
  const std::size_t next = end_of_line(from, false, nodes), previous = end_of_line(from, true, nodes);
  if (to != next && to != previous)
    throw ParseError(quoted(before + " -> " + behind, "is not a line of the ring"),
                     "a line from one node to the next: " + nodes[from].name + " -> " + nodes[next].name +
                         "; where the ring folds back, its second line: " + nodes[from].name + " -> " +
                         nodes[previous].name);
  fault.nodes = {nodes[from].id};
  fault.second_line = to != next;
}

void check_second_line(const Fault& fault, bool folds_back, const RingNodes& nodes) {
  if (!fault.second_line || folds_back) return;
  Fault first = fault;
  first.second_line = false;
  throw ParseError(quoted(to_words(fault, nodes), "is on a second line, which this ring does not have"),
                   "a line in ring order: " + to_words(first, nodes) + "; or redundancy: foldback");
}

void check(const Fault& fault) {
  const Word& word = word_of(fault.name);
  if (fault.nodes.empty() && word.of == Of::line) throw ParseError(needs(word, "a line"), "A -> B");
  if (fault.nodes.empty()) throw ParseError(needs(word, "a node"), "a node of the ring, or several, or all");
  const std::vector<KeyWord> needed = needed_keys_of(word);
  std::vector<std::string> names;
  for (const KeyWord& key : needed) {
    if (is_given(fault, key.key)) return;
    names.emplace_back(key.word);
  }
  if (!needed.empty()) throw MissingKey(word.word, names, needed[0].allowed);
}

namespace {

[[noreturn]] void refuse_bare(const std::string& part, const Word& word) {
  const std::string bare = shown(part), key = key_taking(part, word);
  const std::vector<std::string> known = key_words(word);
  const std::string keys = known.empty() ? "" : ", and as KEY=VALUE " + config::join(known);
  throw BareWord(bare, key, key.empty() ? "one line A -> B" + keys : key + '=' + bare);
}

std::string first_of(const std::vector<std::string>& parts) { return parts.empty() ? "" : parts[0]; }

void set_line_in(Fault& fault, const std::vector<std::string>& who, const RingNodes& nodes) {
  const Word& word = word_of(fault.name);
  std::string line;
  for (const std::string& part : who) line += part + ' ';  // apart: a word too many is no part of a node's name
  for (const std::string between : {"->", ":"}) {
    const std::size_t at = line.find(between);
    if (at == std::string::npos) continue;
    const auto before = split(line.substr(0, at)), behind = split(line.substr(at + between.size()));
    if (before.size() > 1) refuse_bare(before[0], word);
    if (behind.size() > 1) refuse_bare(behind[1], word);
    return set_line(fault, first_of(before), first_of(behind), nodes);
  }
  throw ParseError(needs(word, "a line"), "A -> B, a node and the next one (or A:B, which needs no quotes in a shell)");
}

void set_place(Fault& fault, const std::vector<std::string>& who, const RingNodes& nodes) {
  const Word& word = word_of(fault.name);
  if (word.of == Of::line) return set_line_in(fault, who, nodes);
  for (const std::string& part : who)
    if (!is_node(part, nodes) && !key_taking(part, word).empty()) refuse_bare(part, word);
  set_nodes(fault, who, nodes);
}

}  // namespace

Fault from_words(const std::string& text, const RingNodes& nodes) {
  const std::vector<std::string> parts = split(text);
  Fault fault;
  fault.name = read_word(parts.empty() ? "" : parts[0]).name;
  std::vector<std::string> who;
  std::set<std::string> keys;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::size_t equals = parts[i].find('=');
    if (equals == std::string::npos) {
      who.push_back(parts[i]);
      continue;
    }
    const std::string key = parts[i].substr(0, equals);
    if (!keys.insert(key).second) throw ParseError(quoted(shown(key), "is given twice"), "once");
    set_key(fault, key, parts[i].substr(equals + 1), nodes);
  }
  set_place(fault, who, nodes);
  if (fault.after_packets != 0 && keys.count(kOf) == 0)
    throw MissingKey(word_of(fault.name).word, {kOf}, "a node of the ring, whose data packets are counted");
  if (fault.after_packets == 0 && keys.count(kOf) != 0)
    throw MissingKey(word_of(fault.name).word, {"after_packets"}, std::string(kCount) + ", where `of` is given");
  check(fault);
  return fault;
}

std::string to_words(const Fault& fault, const RingNodes& nodes) {
  const Word& word = word_of(fault.name);
  std::string text = word.word;
  for (const NodeId id : fault.nodes) text += ' ' + name_of(id, nodes);
  if (word.of == Of::line && !fault.nodes.empty()) {
    const std::size_t place = place_of(name_of(fault.nodes[0], nodes), nodes);
    text += " -> " + nodes[end_of_line(place, fault.second_line, nodes)].name;
  }
  for (const Row& row : kRows) {
    const std::string value = row.write(fault);
    if (value.empty() || (word.keys & row.key.key) == 0) continue;
    text += std::string(" ") + row.key.word + '=' + value;
    if (row.key.key == kAfterPackets) text += std::string(" ") + kOf + '=' + name_of(fault.of, nodes);
  }
  return text;
}

}  // namespace limb_ring::fault
