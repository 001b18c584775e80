#include "sim/scenario_sections.h"

#include <algorithm>

#include "config/fault_parse.h"
#include "config/quantity.h"
#include "core/counters.h"
#include "wire/packet.h"

namespace limb_ring::scenario {

using config::Entry;
using config::Option;
using config::Section;
using namespace std::chrono_literals;

namespace {

constexpr config::IntegerRange kFactors{0, 7};
constexpr config::IntegerRange kCounts{1, 1000000};
/// The nodes as the file may call them; a scenario's faults name them by their places in ring order.
fault::RingNodes nodes_by_place(const Entry& entry) {
  fault::RingNodes nodes;
  for (const auto& [name, place] : entry.document().nodes) {
    if (nodes.size() <= place) nodes.resize(place + 1u);
    (config::are_digits(name) ? nodes[place].number : nodes[place].name) = name;
    nodes[place].id = NodeId{place};
  }
  for (const auto& [host, places] : entry.document().nodes_of_hosts)
    for (const std::uint8_t place : places) nodes[place].host = host;
  return nodes;
}

/// Calls `action`; an error that it throws then names the entry's place in the file.
template <class Action>
auto at_entry(const Entry& entry, Action action) {
  try {
    return action();
  } catch (const fault::ParseError& error) {
    entry.refuse(error.problem, error.allowed);
  }
}

/// `A -> B` or nodes, and what the fault is told behind them, in words.
Fault fault_in_words(const Entry& entry, const std::string& word, const fault::RingNodes& nodes) {
  const std::string rest = entry.text("what it is of, such as left_hip -> left_knee or left_knee");
  return at_entry(entry, [&] { return fault::from_words(word + ' ' + rest, nodes); });
}

void set_line(Fault& fault, const std::string& text, const fault::RingNodes& nodes) {
  const Fault line = fault::from_words("heal " + text, nodes);
  fault.nodes = line.nodes;
  fault.second_line = line.second_line;
}

/// Lines and nodes are read as everywhere in scenarios, so that lists of nodes have one form.
void read_member(const config::Member& member, Fault& fault, const fault::RingNodes& nodes) {
  const std::string text = member.name == "nodes" ? "" : member.value.text("a value");
  at_entry(member.value, [&] {
    if (member.name == "nodes")
      fault.nodes = read_nodes(member.value);
    else if (member.name == "line")
      set_line(fault, text, nodes);
    else
      fault::set_key(fault, member.name, text, nodes);
  });
}

/// `{line: A -> B, KEY: VALUE ...}` or `{nodes: N, ...}`
Fault fault_in_a_map(const Entry& entry, const fault::Word& word, const fault::RingNodes& nodes) {
  std::vector<std::string> known{word.of == fault::Of::line ? "line" : "nodes"};
  for (const fault::KeyWord& key : fault::keys_of(word)) known.emplace_back(key.word);
  config::check_names(entry, known, {known[0]});
  Fault fault;
  fault.name = word.name;
  for (const config::Member& member : entry.members("")) read_member(member, fault, nodes);
  if (entry.find("after_packets").has_value() != entry.find("of").has_value())
    entry.refuse("only one of after_packets and of is given", "both, or neither");
  at_entry(entry, [&] { fault::check(fault); });
  return fault;
}

Fault read_fault(const Entry& entry, const fault::Word& word) {
  const fault::RingNodes nodes = nodes_by_place(entry);
  if (entry.is_scalar()) return fault_in_words(entry, word.word, nodes);
  if (entry.is_map()) return fault_in_a_map(entry, word, nodes);
  Fault fault;
  fault.name = word.name;
  if (word.of == fault::Of::line) entry.refuse("a list stands here", "one line: a node -> the next node");
  fault.nodes = read_nodes(entry);
  at_entry(entry, [&] { fault::check(fault); });
  return fault;
}

void read_target(const Entry& entry, Send& send) {
  const bool all = entry.is_scalar() && entry.text("") == "all";
  send.to = all ? wire::kBroadcast : read_place(entry, ", or all");
}

Option<Send> factor_option(const char* name, std::optional<std::uint8_t> Send::*member, const char* meaning) {
  return {name, "none", config::allowed(kFactors), meaning, [=](const Entry& entry, Send& send) {
            send.*member = static_cast<std::uint8_t>(read_integer(entry, kFactors));
          }};
}

const Section<Send>& send_section() {
  static const Section<Send> section{
      config::name_option("name", &Send::name, config::is_part_name, config::kPartNameRule, config::kRequired,
                          "By which conditions speak of it; sends may share one."),
      {"from", config::kRequired, "a node, a list of nodes, or all", "Each of them sends.",
       [](const Entry& entry, Send& send) { send.from = read_nodes(entry); }},
      {"to", "none", "a node, or all", "Its destination; not for an input.", read_target},
      config::integer_option("size", &Send::size, {1, wire::kMaxPayload}, "Bytes of data."),
      factor_option("interrupt", &Send::interrupt, "Instead of `size`: an interrupt packet with this factor."),
      factor_option("input", &Send::input, "Instead of `size` and `to`: this interrupt input is pulled."),
      config::integer_option("priority", &Send::priority, {0, 3}, "0 is the highest."),
      config::time_option("every", &Send::every, 1ns, 3600s, "The period; the first comes at a random part of it."),
      config::integer_option("count", &Send::count, kCounts, "From each; not given, with `every`: without end."),
  };
  return section;
}

Send read_send(const Entry& entry) {
  Send send;
  read_section(entry, send_section(), send);
  const int kinds = (send.size != 0 ? 1 : 0) + (send.interrupt ? 1 : 0) + (send.input ? 1 : 0);
  if (kinds != 1)
    entry.refuse("the send is not exactly one of a packet, an interrupt and an input", "one of size, interrupt, input");
  if (entry.find("to").has_value() == send.input.has_value())
    entry.refuse(send.input ? "the ring's file says where an input leads" : "'to' is missing",
                 "to beside size or interrupt");
  return send;
}

/// `{freeze: node2, for: 100ms}`: what a fault is told stands in it.
void check_none_beside(const std::vector<config::Member>& members) {
  for (const config::Member& member : members) {
    const fault::Word* word = fault::find_word(member.name);
    if (word == nullptr) continue;
    const std::string of = word->of == fault::Of::line ? "line: A -> B" : "nodes: N";
    for (const fault::KeyWord& key : fault::keys_of(*word))
      for (const config::Member& beside : members)
        if (&beside != &member && beside.name == key.word)
          beside.key.refuse("is beside " + member.name + ", not in it",
                            member.name + ": {" + of + ", " + key.word + ": ...}");
  }
}

}  // namespace

void read_action(const Entry& entry, Step& step) {
  std::vector<std::string> words = fault::words();
  words.emplace_back("send");
  for (const std::string& word : soak_words()) words.push_back(word);
  const auto members = entry.members("a fault or a send");
  check_none_beside(members);
  config::check_names(entry, words, {});
  if (members.size() != 1) entry.refuse("not exactly one entry is given", "one of " + config::join(words));
  step.words = entry.in_one_line();
  if (members[0].name == "send") {
    step.action = read_send(members[0].value);
    return;
  }
  if (const auto action = read_soak_action(members[0], nodes_by_place(entry))) {
    step.action = *action;
    return;
  }
  const fault::Word& word = *fault::find_word(members[0].name);
  step.action = read_fault(members[0].value, word);
}

namespace {

using What = decltype(Condition::what);

constexpr config::IntegerRange kAmounts{0, 1000000000};

const std::vector<std::string> kBounds{"at_least", "at_most"};

// The words are those of to_string(), so that reports and files speak alike.
template <class E>
std::vector<std::string> words_up_to(E last) {
  std::vector<std::string> words;
  for (unsigned i = 0; i <= static_cast<unsigned>(last); ++i) words.emplace_back(to_string(static_cast<E>(i)));
  return words;
}

template <class E>
E read_word(const Entry& entry, E last) {
  return static_cast<E>(read_choice(entry, words_up_to(last)));
}

Who read_who(const Entry& entry, bool living) {
  const std::string also = living ? ", all, or living" : ", or all";
  const std::string text = entry.is_scalar() ? entry.text("") : "";
  if (text == "all") return {Who::Kind::all, {}};
  if (living && text == "living") return {Who::Kind::living, {}};
  return {Who::Kind::one, read_place(entry, also)};
}

template <class T>
Option<T> bound(const char* name, std::optional<std::uint64_t> Range::*member, const char* meaning) {
  return {name, "none", config::allowed(kAmounts), meaning, [=](const Entry& entry, T& object) {
            object.range.*member = static_cast<std::uint64_t>(read_integer(entry, kAmounts));
            const Range& range = object.range;
            if (range.at_least && range.at_most && *range.at_least > *range.at_most)
              entry.refuse_value("leaves nothing between at_least and at_most", "at_least up to at_most");
          }};
}

template <class T>
Section<T> with_bounds(Section<T> section) {
  section.push_back(bound<T>("at_least", &Range::at_least, "So many or more."));
  section.push_back(bound<T>("at_most", &Range::at_most, "So many or fewer."));
  return section;
}

template <class T>
Option<T> send_option(const char* name) {
  return config::name_option(name, &T::send, config::is_part_name, config::kPartNameRule, config::kRequired,
                             "The name of a send.");
}

// ---- a section for each kind ----------------------------------------------------------------

void read_state(const Entry& entry, NodeIs& node) {
  std::vector<std::string> words = words_up_to(core::NodeState::duplicate_id);
  words.emplace_back("down");
  const std::size_t word = read_choice(entry, words);
  node.down = word + 1 == words.size();
  if (!node.down) node.state = static_cast<core::NodeState>(word);
  if (node.down && node.who.kind == Who::Kind::living)
    entry.refuse_value("is not a state of a living node", "a state; down of a node, or of all");
}

Section<NodeIs> node_section() {
  return {{"node", config::kRequired, "a node, all, or living", "Of whom.",
           [](const Entry& entry, NodeIs& node) { node.who = read_who(entry, true); }},
          {"is", "none", "a state, or down", "Its state.", read_state},
          {"ring_size", "none", "1 to 255", "As it has learned it.", [](const Entry& entry, NodeIs& node) {
             if (node.down)
               entry.refuse("a node that is down has no ring_size", "ring_size beside another state, or alone");
             node.ring_size = static_cast<unsigned>(read_integer(entry, {1, config::kMostNodes}));
           }}};
}

Section<CpuIs> cpu_section() {
  return {{"cpu", config::kRequired, "a node", "Of whom.",
           [](const Entry& entry, CpuIs& cpu) { cpu.node = read_place(entry); }},
          {"is", "none", "a state", "Its state.",
           [](const Entry& entry, CpuIs& cpu) { cpu.state = read_word(entry, wire::CpuState::failed); }},
          {"boots", "none", config::allowed(kAmounts), "How often it was started.", [](const Entry& entry, CpuIs& cpu) {
             cpu.boots = static_cast<std::uint32_t>(read_integer(entry, kAmounts));
           }}};
}

Section<Located> located_section() {
  return {{"located", config::kRequired, "a node -> a node", "The broken line.",
           [](const Entry& entry, Located& line) { line = read_line(entry); }}};
}

std::vector<std::string> counter_names() {
  std::vector<std::string> names;
  core::Counters{}.each([&](const char* name, const char*, std::uint64_t) { names.emplace_back(name); });
  return names;
}

Section<Counted> counter_section() {
  return with_bounds<Counted>({{"counter", config::kRequired, "a counter", "Its name.",
                                [](const Entry& entry, Counted& counted) {
                                  counted.counter = counter_names()[read_choice(entry, counter_names())];
                                }},
                               {"of", config::kRequired, "a node, or all", "Whose; of all: their sum.",
                                [](const Entry& entry, Counted& counted) { counted.of = read_who(entry, false); }}});
}

Section<Results> results_section() {
  return with_bounds<Results>(
      {send_option<Results>("results"),
       {"are", config::kRequired, "a result", "What became of them.",
        [](const Entry& entry, Results& results) { results.are = read_word(entry, core::Outcome::cancelled); }}});
}

Section<Taken> taken_section() { return with_bounds<Taken>({send_option<Taken>("taken")}); }

Section<Latency> latency_section() {
  return {send_option<Latency>("latency"),
          {"at_most", config::kRequired, "a time, or {sim: TIME, live: TIME}", "The longest allowed.",
           [](const Entry& entry, Latency& latency) { latency.at_most = read_limit(entry); }}};
}

// ---- and what has to be in it ---------------------------------------------------------------

template <class T>
T read_kind(const Entry& entry, const Section<T>& section, const std::vector<std::string>& one_of) {
  T condition;
  read_section(entry, section, condition);
  const auto given = [&](const std::string& name) { return entry.find(name).has_value(); };
  if (!one_of.empty() && std::none_of(one_of.begin(), one_of.end(), given))
    entry.refuse("it does not say what to look for", config::join(one_of));
  return condition;
}

struct Kind {
  const char* word;
  What (*read)(const Entry&);
};
const Kind kKinds[] = {
    {"node",
     [](const Entry& e) -> What {
       return read_kind(e, node_section(), {"is", "ring_size"});
     }},
    {"cpu",
     [](const Entry& e) -> What {
       return read_kind(e, cpu_section(), {"is", "boots"});
     }},
    {"located", [](const Entry& e) -> What { return read_kind(e, located_section(), {}); }},
    {"counter", [](const Entry& e) -> What { return read_kind(e, counter_section(), kBounds); }},
    {"results", [](const Entry& e) -> What { return read_kind(e, results_section(), kBounds); }},
    {"taken", [](const Entry& e) -> What { return read_kind(e, taken_section(), kBounds); }},
    {"latency", [](const Entry& e) -> What { return read_kind(e, latency_section(), {}); }},
};

}  // namespace

Condition read_condition(const Entry& entry) {
  std::vector<std::string> words;
  for (const Kind& kind : kKinds) words.emplace_back(kind.word);
  for (const Kind& kind : kKinds)
    if (entry.find(kind.word)) return {kind.read(entry), entry.in_one_line()};
  entry.refuse("this is not a condition", "a map with one of " + config::join(words));
}

// What only the world of `ring_sim soak` has, as it stands in a scenario.

using SoakKind = SoakAction::Kind;

namespace {

constexpr const char* kLine = "a line such as node1 -> node2";
constexpr config::IntegerRange kNth{1, 1000}, kByte{0, 543}, kBits{1, 255};

/// `A -> B`, as of any fault.
void set_line(const Entry& entry, SoakAction& action, const fault::RingNodes& nodes) {
  try {
    const fault::Fault line = fault::from_words("heal " + entry.text(kLine), nodes);
    action.node = line.nodes[0];
    action.second_line = line.second_line;
  } catch (const fault::ParseError& error) {
    entry.refuse(error.problem, error.allowed);
  }
}

/// `{cut: A -> B}` or `{mend: A -> B}`
SoakAction read_wire(const Entry& entry, SoakKind cut, SoakKind mend, const fault::RingNodes& nodes) {
  config::check_names(entry, {"cut", "mend"}, {});
  const auto members = entry.members("{cut: A -> B} or {mend: A -> B}");
  if (members.size() != 1) entry.refuse("not exactly one entry is given", "cut or mend");
  SoakAction action;
  action.kind = members[0].name == "cut" ? cut : mend;
  set_line(members[0].value, action, nodes);
  if (cut == SoakKind::cut_cable && action.second_line)
    members[0].value.refuse("is named against ring order", "its two nodes in ring order");
  return action;
}

/// `{lost: A -> B, nth: N}` or `{damaged: A -> B, nth: N, byte: I, bits: B}`
SoakAction read_slice(const Entry& entry, const fault::RingNodes& nodes) {
  const auto lost = entry.find("lost"), damaged = entry.find("damaged");
  if (lost.has_value() == damaged.has_value()) entry.refuse("not exactly one entry is given", "lost or damaged");
  config::check_names(
      entry,
      lost ? std::vector<std::string>{"lost", "nth"} : std::vector<std::string>{"damaged", "nth", "byte", "bits"}, {});
  SoakAction action;
  action.kind = lost ? SoakKind::lose_slice : SoakKind::damage_slice;
  set_line(lost ? *lost : *damaged, action, nodes);
  if (const auto nth = entry.find("nth")) action.nth = static_cast<unsigned>(read_integer(*nth, kNth));
  if (const auto byte = entry.find("byte")) action.byte = static_cast<unsigned>(read_integer(*byte, kByte));
  if (const auto bits = entry.find("bits")) action.bits = static_cast<std::uint8_t>(read_integer(*bits, kBits));
  return action;
}

}  // namespace

std::vector<std::string> soak_words() { return {"wire", "cable", "slice", "cancel"}; }

std::optional<SoakAction> read_soak_action(const config::Member& action, const fault::RingNodes& nodes) {
  if (action.name == "wire") return read_wire(action.value, SoakKind::cut_wire, SoakKind::mend_wire, nodes);
  if (action.name == "cable") return read_wire(action.value, SoakKind::cut_cable, SoakKind::mend_cable, nodes);
  if (action.name == "slice") return read_slice(action.value, nodes);
  if (action.name != "cancel") return std::nullopt;
  SoakAction cancel;
  cancel.kind = SoakKind::cancel;
  cancel.node = read_place(action.value);
  return cancel;
}

}  // namespace limb_ring::scenario
