#include "sim/load_scenario.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "config/entry.h"
#include "config/fault_parse.h"
#include "config/load_ring.h"
#include "config/quantity.h"
#include "config/ring_config.h"
#include "sim/goals.h"
#include "sim/planned_ring.h"
#include "sim/scenario_sections.h"
#include "sim/soak_stage.h"

namespace limb_ring::scenario {

using config::ConfigError;
using config::Entry;

namespace {

/// A named send is told apart by one byte of its data.
constexpr std::size_t kMostNames = 255;
constexpr const char* kNameRule = "the name of a send of this scenario";

config::RingConfig ring_of(const Entry& file) {
  const auto path = file.find("ring"), nodes = file.find("nodes");
  if (path.has_value() == nodes.has_value())
    file.refuse(path ? "ring and nodes are both given" : "neither ring nor nodes is given",
                "ring: the YAML file of a ring; or nodes: 2 to 255, for plain nodes");
  if (nodes) {
    config::RingConfig ring = config::plain_ring(
        "plain", static_cast<unsigned>(read_integer(*nodes, {config::kFewestNodes, config::kMostNodes})));
    if (const auto redundancy = file.find("redundancy")) ring.redundancy = read_redundancy(*redundancy);
    return ring;
  }
  if (const auto redundancy = file.find("redundancy"))
    redundancy->refuse("the ring's file gives the redundancy", "redundancy only beside nodes");
  const std::filesystem::path beside = std::filesystem::path(file.document().name).parent_path();
  const std::string ring = (beside / path->text("a file")).lexically_normal().string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(ring, error))
    path->refuse_value("does not exist: there is no file " + ring,
                       "the YAML file of a ring; its path from the folder of this file");
  return config::load_ring(ring);
}

/// In the file nodes have names or ids; we keep them as places in ring order.
void learn_nodes(config::Document& document, const config::RingConfig& ring) {
  for (std::size_t place = 0; place < ring.nodes.size(); ++place) {
    document.nodes[ring.nodes[place].name] = static_cast<std::uint8_t>(place);
    document.nodes[std::to_string(ring.nodes[place].id)] = static_cast<std::uint8_t>(place);
    if (const std::string host = fault::host_name(ring, ring.nodes[place]); !host.empty())
      document.nodes_of_hosts[host].push_back(static_cast<std::uint8_t>(place));
  }
}

std::vector<std::string> send_names(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const Step& step : scenario.steps) {
    const auto* send = std::get_if<Send>(&step.action);
    if (send && std::find(names.begin(), names.end(), send->name) == names.end()) names.push_back(send->name);
  }
  return names;
}

void check_condition(const Entry& condition, const std::vector<std::string>& names) {
  for (const char* key : {"results", "taken", "latency"}) {
    const auto name = condition.find(key);
    if (name && std::find(names.begin(), names.end(), name->text(kNameRule)) == names.end())
      name->refuse_value("is not a send", std::string(kNameRule) + " (" + config::join(names) + ")");
  }
}

void check_line(const Entry& entry, const Step& step, const config::RingConfig& ring) {
  const auto* fault = std::get_if<fault::Fault>(&step.action);
  const auto* action = std::get_if<SoakAction>(&step.action);
  if (ring.folds_back()) return;
  if (action && (action->kind == SoakAction::Kind::cut_cable || action->kind == SoakAction::Kind::mend_cable))
    entry.find("do")->refuse("only a ring that folds back has cables with two lines",
                             "redundancy: foldback, or the fault of a wire");
  if ((fault && fault->second_line) || (action && action->second_line))
    entry.find("do")->refuse("that is the second line of a ring that folds back", "a line in ring order");
}

/// An input that is wired to nothing sends nothing.
void check_input(const Entry& entry, const Step& step, const config::RingConfig& ring) {
  const auto* send = std::get_if<Send>(&step.action);
  if (!send || !send->input) return;
  for (const NodeId from : send->from) {
    const config::NodeConfig& node = ring.nodes[from];
    if (!node.inputs[*send->input])
      entry.find("do")->find("send")->find("input")->refuse_value(
          "is wired to nothing at node '" + node.name + "'",
          "one of the `inputs` that the ring's file gives this node");
  }
}

void check_world(const Entry& entry, const Step& step, World world) {
  const auto* fault = std::get_if<fault::Fault>(&step.action);
  if (world == World::soak && fault && !SoakStage::can(*fault))
    entry.find("do")->refuse("in the world soak CPUs are not programs", "reset, not_reading and resume of a CPU");
  if (world != World::soak && std::holds_alternative<SoakAction>(step.action))
    entry.find("do")->refuse("only the world soak has that", "world: soak");
}

/// What `rate` may be: in the soak's world lines may take no time.
std::uint64_t rate_of(const Entry& entry, World world) {
  return world == World::soak ? read_rate(entry) : read_line_rate(entry);
}

/// Errors that no single entry shows: unknown sends, lines and inputs that the ring has not, times that run backwards.
void check_scenario(const Entry& file, const Scenario& scenario) {
  const std::vector<std::string> names = send_names(scenario);
  config::Problems problems;
  if (names.size() > kMostNames)
    file.note(problems, "the scenario has too many sends", std::to_string(kMostNames) + " names");
  for (const char* list : {"always", "never"})
    if (const auto conditions = file.find(list))
      for (const Entry& condition : conditions->items("")) problems.gather([&] { check_condition(condition, names); });
  nanoseconds latest{0};
  const std::vector<Entry> steps = file.find("steps")->items("");
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Step& step = scenario.steps[i];
    if (const auto when = steps[i].find("when")) problems.gather([&] { check_condition(*when, names); });
    problems.gather([&] { check_line(steps[i], step, scenario.ring); });
    problems.gather([&] { check_input(steps[i], step, scenario.ring); });
    problems.gather([&] { check_world(steps[i], step, scenario.world); });
    if (!step.at) continue;
    if (*step.at < latest)
      problems.gather([&] { steps[i].find("at")->refuse_value("is before an earlier step", "times in order"); });
    latest = *step.at;
  }
  problems.refuse_all();
}

/// The file of a ring, taken for a scenario: its nodes are a list, or what it says is only said of rings.
void refuse_ring(const Entry& file) {
  if (!file.is_map() || file.find("steps")) return;
  if (const auto nodes = file.find("nodes"); nodes && nodes->is_list())
    nodes->refuse("this is the file of a ring, not a scenario",
                  "'ringctl up FILE' for a ring; a scenario names it: 'ring: FILE'");
}

}  // namespace

bool expects_something(const Scenario& scenario) {
  const auto waits = [](const Step& step) { return step.when.has_value(); };
  return scenario.world == World::soak || !scenario.always.empty() || !scenario.never.empty() ||
         !scenario.sometimes.empty() || std::any_of(scenario.steps.begin(), scenario.steps.end(), waits);
}

bool lasts(const Scenario& scenario) { return scenario.world == World::soak || !scenario.steps.empty(); }

namespace {

/// The ring, and what its lines are, before anything that may refer to them is read.
void read_ring(const Entry& file, Scenario& scenario) {
  scenario.ring = ring_of(file);
  if (const auto world = file.find("world")) scenario.world = read_world(*world);
  if (scenario.world == World::soak && file.find("ring"))
    file.find("ring")->refuse("the world soak has plain nodes", "nodes instead of ring");
  learn_nodes(file.document(), scenario.ring);
  std::uint64_t rate = sim::kUsualRate;
  nanoseconds delay = sim::kUsualRelayDelay;
  if (const auto entry = file.find("rate")) rate = rate_of(*entry, scenario.world);
  if (const auto entry = file.find("relay_delay")) delay = read_relay_delay(*entry);
  scenario.rates_assumed = sim::assumes_lines(scenario.ring);
  scenario.ring = sim::with_assumed_lines(std::move(scenario.ring), rate, delay);
}

}  // namespace

Scenario parse_scenario(const std::string& text, const std::string& name) {
  config::Document document;
  document.name = name;
  const Entry file(config::parse_yaml(text, name), "", document);
  refuse_ring(file);
  Scenario scenario;
  scenario.path = name;
  config::Problems problems;
  problems.gather([&] { check_names(file, names_of(scenario_section()), {}); });
  if (problems.gather([&] { read_ring(file, scenario); }))
    problems.gather([&] { read_section(file, scenario_section(), scenario); });
  problems.refuse_all();
  check_scenario(file, scenario);
  return scenario;
}

Scenario load_scenario(const std::string& path) { return parse_scenario(config::read_file(path), path); }

using config::Option;
using config::Section;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t kMostSteps = 10000;
constexpr const char* kTitleRule = "a line of 1 to 100 bytes, UTF-8 without control characters";
constexpr const char* kLineRule = "two nodes of the ring, such as left_hip -> left_knee";
constexpr const char* kGoalRule = "the name of a goal, as 'ring_sim soak --goals' lists them";
constexpr config::IntegerRange kDrifts{-100'000, 100'000};
constexpr config::IntegerRange kOrders{0, 1'000'000};
constexpr config::TimeRange kTimes{0s, 3600s, 1ns};
constexpr config::TimeRange kDelays{0s, 1s, 1ns};

/// For options that load_scenario reads before all others, because they decide which nodes there are.
Option<Scenario> read_already(const char* name, const char* allowed, const char* meaning) {
  return {name, "none", allowed, meaning, [](const Entry&, Scenario&) {}};
}

std::string read_title(const Entry& entry) {
  const std::string title = entry.text(kTitleRule);
  if (!config::is_plain_text(title)) entry.refuse("the title has bytes that are not plain text", kTitleRule);
  if (title.empty() || title.size() > 100) entry.refuse_value("is not a title", kTitleRule);
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

std::vector<int> read_clocks(const Entry& entry, const config::RingConfig& ring) {
  std::vector<int> clocks(ring.nodes.size(), 0);
  const auto& nodes = entry.document().nodes;
  for (const config::Member& member : entry.members("a map of nodes and millionths, such as {node1: 200}")) {
    const auto node = nodes.find(member.name);
    if (node == nodes.end())
      member.value.refuse("'" + member.name + "' is not a node of the ring", "a node of the ring");
    clocks[node->second] = static_cast<int>(read_integer(member.value, kDrifts));
  }
  return clocks;
}

std::size_t read_goal(const Entry& entry) {
  const std::string name = entry.text(kGoalRule);
  if (const auto goal = sim::goal_named(name)) return *goal;
  std::vector<std::string> names;
  for (const sim::Goal& goal : sim::goals()) names.emplace_back(goal.name);
  const std::string meant = config::closest(name, names);
  entry.refuse_value(meant.empty() ? "is not a goal" : "is not a goal, did you mean '" + meant + "'?", kGoalRule);
}

void check_step(const Entry& entry, const Step& step) {
  if (step.at && step.after) entry.refuse("at and after are both given", "one of them");
  if (entry.find("within") && !step.when)
    entry.find("within")->refuse("the step has no when", "within only beside when");
  if (step.when && !entry.find("within")) entry.refuse("'within' is missing", "within beside when");
}

Option<Step> time_of_step(const char* name, std::optional<nanoseconds> Step::*member, const char* meaning) {
  return {name, "none", config::allowed(kTimes), meaning,
          [=](const Entry& entry, Step& step) { step.*member = read_time(entry, kTimes); }};
}

}  // namespace

std::uint64_t read_line_rate(const Entry& entry) {
  const std::uint64_t rate = read_rate(entry);
  if (rate == 0) entry.refuse_value("is not possible here", "a rate, because lines under a virtual clock have one");
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

namespace {

/// One, or all of a host.
std::vector<NodeId> places_called(const Entry& entry, const char* also) {
  const config::Document& document = entry.document();
  const std::string name = entry.is_scalar() ? entry.text("") : "";
  const auto host = document.nodes_of_hosts.find(name);
  if (document.nodes.count(name) != 0 || host == document.nodes_of_hosts.end()) return {read_place(entry, also)};
  std::vector<NodeId> places;
  for (const std::uint8_t place : host->second) places.emplace_back(place);
  return places;
}

}  // namespace

std::vector<NodeId> read_nodes(const Entry& entry) {
  std::vector<NodeId> nodes;
  if (entry.is_scalar() && entry.text("") == "all") {
    for (const auto& [name, place] : entry.document().nodes) nodes.emplace_back(place);
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
  }
  if (entry.is_scalar()) return places_called(entry, ", a host, a list of them, or all");
  for (const Entry& item : entry.items("a node, a list of nodes, or all", config::kMostNodes))
    for (const NodeId place : places_called(item, ", or a host")) {
      nodes.push_back(place);
      if (std::count(nodes.begin(), nodes.end(), place) > 1) item.refuse_value("is named twice", "each node once");
    }
  return nodes;
}

Located read_line(const Entry& entry) {
  const std::string text = entry.text(kLineRule);
  const std::size_t arrow = text.find(" -> ");
  const auto& nodes = entry.document().nodes;
  const auto before = nodes.find(text.substr(0, arrow));
  const auto behind = arrow == std::string::npos ? nodes.end() : nodes.find(text.substr(arrow + 4));
  if (before == nodes.end() || behind == nodes.end()) entry.refuse_value("is not a line", kLineRule);
  return {NodeId{before->second}, NodeId{behind->second}};
}

const Section<Scenario>& scenario_section() {
  static const Section<Scenario> section{
      {"scenario", config::kRequired, kTitleRule, "The title of the scenario.",
       [](const Entry& entry, Scenario& scenario) { scenario.name = read_title(entry); }},
      read_already("ring", "a file", "The YAML file of the ring. Its path starts at the folder of this file."),
      read_already("nodes", "2 to 255", "Instead of `ring`: the number of plain nodes node0, node1 and so on."),
      read_already("rate", config::kAllowedRates, "Data rate of lines for which the ring's file gives none."),
      read_already("relay_delay", "a time", "Relay delay at lines for which the ring's file gives no rate."),
      read_already("redundancy", "none, foldback", "Only beside `nodes`. foldback: a second, counter-rotating line."),
      read_already("world", "usual, soak",
                   "soak: the rings of `ring_sim soak`, with short times and few buffers. At the end all faults are "
                   "ended, and the ring has to become whole again."),
      {"seed", "1", "a whole number", "Seed of all random choices.",
       [](const Entry& entry, Scenario& scenario) {
         scenario.seed = static_cast<std::uint64_t>(read_integer(entry, {0, INT64_MAX}));
       }},
      {"order", "that of the ring's file, or 0", config::allowed(kOrders),
       "With programs under the virtual clock: seed of the order in which they act in one instant, one after "
       "the other. 0: side by side.",
       [](const Entry& entry, Scenario& scenario) {
         scenario.ring.virtual_clock.order = static_cast<std::uint32_t>(read_integer(entry, kOrders));
       }},
      {"only", "none", "sim", "sim: the scenario runs only under the virtual clock.",
       [](const Entry& entry, Scenario& scenario) { scenario.only_sim = read_choice(entry, {"sim"}) == 0; }},
      config::time_option(
          "boot_time", &Scenario::boot_time, 0ns, 60s,
          "Time from the reset of a CPU to its first message, under the virtual clock. Live it is what it is."),
      {"clocks", "{}", "a map of nodes and millionths, -100000 to 100000",
       "Nodes whose clock is so many millionths too fast, or below 0 too slow: then the times that it keeps are "
       "shorter, "
       "or longer.",
       [](const Entry& entry, Scenario& scenario) { scenario.clocks = read_clocks(entry, scenario.ring); }},
      {"absent", "[]", "a node or a list of nodes", "Nodes that are not there at the start.",
       [](const Entry& entry, Scenario& scenario) {
         scenario.absent = read_nodes(entry);  // the others are counted by it
         if (scenario.absent.size() == scenario.ring.nodes.size())
           entry.refuse("no node would be left", "at most all nodes but one");
       }},
      {"steps", config::kRequired, "a list of steps", "What is done and what is expected, in this order.",
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
      conditions_option("always", &Scenario::always, "Conditions that hold at every moment."),
      conditions_option("never", &Scenario::never, "Conditions that never hold."),
      {"sometimes", "[]", "a list of goals", "Situations that have been met at the end (docs/explanation/soak.md).",
       [](const Entry& entry, Scenario& scenario) {
         for (const Entry& item : entry.items("a list of goals", sim::goals().size()))
           scenario.sometimes.push_back(read_goal(item));
       }},
  };
  return section;
}

const Section<Step>& step_section() {
  static const Section<Step> section{
      time_of_step("at", &Step::at, "Wait until this time from the start."),
      time_of_step("after", &Step::after, "Wait this long after the previous step."),
      {"when", "none", "a condition", "Then wait until this condition holds.",
       [](const Entry& entry, Step& step) { step.when = read_condition(entry); }},
      {"within", "none", "a time, or {sim: TIME, live: TIME}", "`when` has to hold within this time.",
       [](const Entry& entry, Step& step) { step.within = read_limit(entry); }},
      {"do", "none", "a fault or a send", "Then do this.", read_action},
  };
  return section;
}

}  // namespace limb_ring::scenario
