#include <algorithm>

#include "study/scenario/sections.h"

namespace limb_ring::study::scenario {

using config::Entry;
using config::Option;
using config::Section;
using namespace std::chrono_literals;

namespace {

constexpr config::IntegerRange kFactors{0, 7};
constexpr config::IntegerRange kCounts{1, 1000000};
constexpr const char* kLineOfRing = "a line of the ring: a node -> the next node";

NodeId read_line_of_ring(const Entry& entry) {
  const Located line = read_line(entry);
  std::size_t nodes = 0;
  for (const auto& [name, place] : entry.document().nodes) nodes = std::max<std::size_t>(nodes, place + 1u);
  if (line.behind != (line.before + 1) % nodes) entry.refuse_value("is no line of it", kLineOfRing);
  return line.before;
}

const Section<Fault>& packets_section() {
  static const Section<Fault> section{
      {"line", config::kRequired, kLineOfRing, "The line.",
       [](const Entry& entry, Fault& fault) { fault.nodes = {read_line_of_ring(entry)}; }},
      config::integer_option("packets", &Fault::packets, kCounts, "The next so many."),
      config::integer_option("once_in", &Fault::once_in, kCounts, "On average one in so many, by the seed."),
      config::time_option("for", &Fault::lasts, 1ns, 3600s, "For so long."),
  };
  return section;
}

Fault read_fault(const Entry& entry, const FaultWord& word) {
  Fault fault;
  fault.name = word.name;
  if (word.of == FaultOf::line) fault.nodes = {read_line_of_ring(entry)};
  if (word.of == FaultOf::packets) read_section(entry, packets_section(), fault);
  if (word.of == FaultOf::nodes) fault.nodes = read_nodes(entry);
  return fault;
}

void read_target(const Entry& entry, Send& send) {
  const bool all = entry.is_scalar() && entry.text("") == "all";
  send.to = all ? wire::kBroadcast : read_node(entry, ", or all");
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
      config::integer_option("size", &Send::size, {1, 512}, "Bytes of data."),
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

}  // namespace

void read_deed(const Entry& entry, Step& step) {
  std::vector<std::string> words = fault_words();
  words.emplace_back("send");
  config::check_names(entry, words, {});
  const auto members = entry.members("a fault or a send");
  if (members.size() != 1) entry.refuse("it is not one thing", "one of " + config::join(words));
  step.words = entry.in_one_line();
  if (members[0].name == "send") {
    step.deed = read_send(members[0].value);
    return;
  }
  for (const FaultWord& word : kFaults)
    if (members[0].name == word.word) step.deed = read_fault(members[0].value, word);
}

}  // namespace limb_ring::study::scenario
