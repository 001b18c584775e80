#include "config/characters.h"
#include "config/fault_parse.h"
#include "sim/scenario_sections.h"
#include "wire/data_packet.h"

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
    entry.refuse("after_packets and of are not both given", "both, or neither");
  at_entry(entry, [&] { fault::check(fault); });
  return fault;
}

Fault read_fault(const Entry& entry, const fault::Word& word) {
  const fault::RingNodes nodes = nodes_by_place(entry);
  if (entry.is_scalar()) return fault_in_words(entry, word.word, nodes);
  if (entry.is_map()) return fault_in_a_map(entry, word, nodes);
  Fault fault;
  fault.name = word.name;
  if (word.of == fault::Of::line) entry.refuse("it is a list", "one line: a node -> the next node");
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
  if (kinds != 1) entry.refuse("it is not one of a packet, an interrupt and an input", "one of size, interrupt, input");
  if (entry.find("to").has_value() == send.input.has_value())
    entry.refuse(send.input ? "where an input leads, the ring's file says" : "'to' is missing",
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
  if (members.size() != 1) entry.refuse("it is not one thing", "one of " + config::join(words));
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

}  // namespace limb_ring::scenario
