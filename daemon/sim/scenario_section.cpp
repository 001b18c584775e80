#include <algorithm>
#include <set>

#include "config/characters.h"
#include "sim/scenario_sections.h"

namespace limb_ring::scenario {

using config::Entry;
using config::Option;
using config::Section;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t kMostSteps = 10000;
constexpr const char* kTitleRule = "a line of 1 to 100 bytes, UTF-8 without control characters";
constexpr const char* kLineRule = "two nodes of the ring, such as left_hip -> left_knee";
constexpr config::TimeRange kTimes{0s, 3600s, 1ns};
constexpr config::TimeRange kDelays{0s, 1s, 1ns};

/// For options that load_scenario reads before all others, because they decide which nodes there are.
Option<Scenario> read_already(const char* name, const char* allowed, const char* meaning) {
  return {name, "none", allowed, meaning, [](const Entry&, Scenario&) {}};
}

std::string read_title(const Entry& entry) {
  const std::string title = entry.text(kTitleRule);
  if (!config::is_plain_text(title)) entry.refuse("it has bytes that are not plain text", kTitleRule);
  if (title.empty() || title.size() > 100) entry.refuse_value("is not one", kTitleRule);
  return title;
}

Option<Scenario> conditions_option(const char* name, std::vector<Condition> Scenario::*member, const char* meaning) {
  return {name, "[]", "a list of conditions", meaning, [=](const Entry& entry, Scenario& scenario) {
            config::Problems problems;
            for (const Entry& item : entry.items("a list of conditions", kMostSteps))
              problems.gather([&] { (scenario.*member).push_back(read_condition(item)); });
            problems.refuse_all();
          }};
}

void check_step(const Entry& entry, const Step& step) {
  if (step.at && step.after) entry.refuse("at and after are both given", "one of them");
  if (entry.find("within") && !step.when) entry.find("within")->refuse("there is no when", "within beside when");
  if (step.when && !entry.find("within")) entry.refuse("'within' is missing", "within beside when");
}

Option<Step> time_of_step(const char* name, std::optional<nanoseconds> Step::*member, const char* meaning) {
  return {name, "none", config::allowed(kTimes), meaning,
          [=](const Entry& entry, Step& step) { step.*member = read_time(entry, kTimes); }};
}

}  // namespace

std::uint64_t read_line_rate(const Entry& entry) {
  const std::uint64_t rate = read_rate(entry);
  if (rate == 0) entry.refuse_value("takes no time", "a rate: under a virtual clock lines have one");
  return rate;
}

World read_world(const Entry& entry) { return static_cast<World>(read_choice(entry, {"usual", "soak"})); }

config::RingConfig::Redundancy read_redundancy(const Entry& entry) {
  return static_cast<config::RingConfig::Redundancy>(read_choice(entry, {"none", "foldback"}));
}

nanoseconds read_relay_delay(const Entry& entry) { return read_time(entry, kDelays); }

Limit read_limit(const Entry& entry) {
  if (entry.is_map()) config::check_names(entry, {"sim", "live"}, {"sim"});
  const nanoseconds sim = read_time(entry.is_map() ? *entry.find("sim") : entry, kTimes);
  const auto live = entry.is_map() ? entry.find("live") : std::nullopt;
  return {sim, live ? read_time(*live, kTimes) : sim + kLiveGuard};
}

std::vector<NodeId> read_nodes(const Entry& entry) {
  std::vector<NodeId> nodes;
  if (entry.is_scalar() && entry.text("") == "all") {
    for (const auto& [name, place] : entry.document().nodes) nodes.emplace_back(place);
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
  }
  if (entry.is_scalar()) return {read_place(entry, ", a list of them, or all")};
  for (const Entry& item : entry.items("a node, a list of nodes, or all", config::kMostNodes)) {
    nodes.push_back(read_place(item));
    if (std::count(nodes.begin(), nodes.end(), nodes.back()) > 1) item.refuse_value("is named twice", "each node once");
  }
  return nodes;
}

Located read_line(const Entry& entry) {
  const std::string text = entry.text(kLineRule);
  const std::size_t arrow = text.find(" -> ");
  const auto& nodes = entry.document().nodes;
  const auto before = nodes.find(text.substr(0, arrow));
  const auto behind = arrow == std::string::npos ? nodes.end() : nodes.find(text.substr(arrow + 4));
  if (before == nodes.end() || behind == nodes.end()) entry.refuse_value("is no line", kLineRule);
  return {NodeId{before->second}, NodeId{behind->second}};
}

const Section<Scenario>& scenario_section() {
  static const Section<Scenario> section{
      {"scenario", config::kRequired, kTitleRule, "What it is about.",
       [](const Entry& entry, Scenario& scenario) { scenario.name = read_title(entry); }},
      read_already("ring", "a file", "The YAML file of the ring, looked for beside this file."),
      read_already("nodes", "2 to 255", "Instead of `ring`: so many plain nodes, node0 and so on."),
      read_already("rate", config::kAllowedRates, "Of lines that the ring's file gives none."),
      read_already("relay_delay", "a time", "Of lines that the ring's file gives no rate."),
      read_already("redundancy", "none, foldback", "Beside `nodes`: foldback is a second line, against the ring."),
      read_already(
          "world", "usual, soak",
          "soak: as `ring_sim soak` has it, with short times and few buffers; at its end all is mended, and the "
          "ring has to be whole again."),
      {"seed", "1", "a whole number", "Decides everything random.",
       [](const Entry& entry, Scenario& scenario) {
         scenario.seed = static_cast<std::uint64_t>(read_integer(entry, {0, INT64_MAX}));
       }},
      {"only", "none", "sim", "For the virtual clock alone.",
       [](const Entry& entry, Scenario& scenario) { scenario.only_sim = read_choice(entry, {"sim"}) == 0; }},
      config::time_option(
          "boot_time", &Scenario::boot_time, 0ns, 60s,
          "From a reset of a CPU to its first word, under the virtual clock; live it takes what it takes."),
      {"absent", "[]", "a node or a list of nodes", "Not there at the start.",
       [](const Entry& entry, Scenario& scenario) {
         scenario.absent = read_nodes(entry);  // the others are counted by it
         if (scenario.absent.size() == scenario.ring.nodes.size())
           entry.refuse("no node would be there", "all nodes but one, at most");
       }},
      {"steps", config::kRequired, "a list of steps", "What happens and what is seen, in this order.",
       [](const Entry& entry, Scenario& scenario) {
         config::Problems problems;
         for (const Entry& item : entry.items("a list of steps", kMostSteps))
           problems.gather([&] {
             Step step;
             read_section(item, step_section(), step);
             check_step(item, step);
             scenario.steps.push_back(std::move(step));
           });
         problems.refuse_all();
       }},
      conditions_option("always", &Scenario::always, "Holds at every moment."),
      conditions_option("never", &Scenario::never, "Holds at no moment."),
  };
  return section;
}

const Section<Step>& step_section() {
  static const Section<Step> section{
      time_of_step("at", &Step::at, "Wait until then, from the start."),
      time_of_step("after", &Step::after, "Wait so long after the step before."),
      {"when", "none", "a condition", "Then wait until it holds.",
       [](const Entry& entry, Step& step) { step.when = read_condition(entry); }},
      {"within", "none", "a time, or {sim: TIME, live: TIME}", "`when` has to hold by then.",
       [](const Entry& entry, Step& step) { step.within = read_limit(entry); }},
      {"do", "none", "a fault or a send", "Then do this.", read_action},
  };
  return section;
}

}  // namespace limb_ring::scenario
