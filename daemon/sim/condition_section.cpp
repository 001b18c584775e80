#include <algorithm>

#include "core/counters.h"
#include "sim/scenario_sections.h"

namespace limb_ring::scenario {

using config::Entry;
using config::Option;
using config::Section;
using namespace std::chrono_literals;

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
    entry.refuse_value("is what no living node is", "a state; down of a node, or of all");
}

Section<NodeIs> node_section() {
  return {{"node", config::kRequired, "a node, all, or living", "Of whom.",
           [](const Entry& entry, NodeIs& node) { node.who = read_who(entry, true); }},
          {"is", "none", "a state, or down", "Its state.", read_state},
          {"ring_size", "none", "1 to 255", "As it has learned it.", [](const Entry& entry, NodeIs& node) {
             if (node.down) entry.refuse("a node that is down has none", "ring_size beside another state, or alone");
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
  entry.refuse("it is no condition", "a map with one of " + config::join(words));
}

}  // namespace limb_ring::scenario
