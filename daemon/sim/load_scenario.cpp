#include "sim/load_scenario.h"

#include <algorithm>
#include <filesystem>

#include "config/load_ring.h"
#include "config/plain_ring.h"
#include "config/yaml_file.h"
#include "sim/planned_ring.h"
#include "sim/scenario_sections.h"

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
                "ring: the YAML file of a ring, beside this file; or nodes: 2 to 255 plain ones");
  if (nodes) {
    config::RingConfig ring = config::plain_ring(
        "plain", static_cast<unsigned>(read_integer(*nodes, {config::kFewestNodes, config::kMostNodes})));
    if (const auto redundancy = file.find("redundancy")) ring.redundancy = read_redundancy(*redundancy);
    return ring;
  }
  if (const auto redundancy = file.find("redundancy"))
    redundancy->refuse("the ring's file says that", "nodes beside it");
  const std::filesystem::path beside = std::filesystem::path(file.document().name).parent_path();
  const std::string ring = (beside / path->text("a file")).lexically_normal().string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(ring, error))
    path->refuse_value("is no file: there is no " + ring, "the YAML file of a ring, looked for beside this file");
  return config::load_ring(ring);
}

/// In the file nodes have names or ids; we keep them as places in ring order.
void learn_nodes(config::Document& document, const config::RingConfig& ring) {
  for (std::size_t place = 0; place < ring.nodes.size(); ++place) {
    document.nodes[ring.nodes[place].name] = static_cast<std::uint8_t>(place);
    document.nodes[std::to_string(ring.nodes[place].id)] = static_cast<std::uint8_t>(place);
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
      name->refuse_value("is none", std::string(kNameRule) + " (" + config::join(names) + ")");
  }
}

void check_line(const Entry& entry, const Step& step, const config::RingConfig& ring) {
  const auto* fault = std::get_if<fault::Fault>(&step.action);
  const auto* action = std::get_if<SoakAction>(&step.action);
  if (ring.folds_back()) return;
  if (action && (action->kind == SoakAction::Kind::cut_cable || action->kind == SoakAction::Kind::mend_cable))
    entry.find("do")->refuse("only a ring that folds back has cables of two lines", "redundancy: foldback, or wire");
  if ((fault && fault->second_line) || (action && action->second_line))
    entry.find("do")->refuse("that line would be the second one of a ring that folds back", "a line in ring order");
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

// The CPUs of the soak's world are no programs.
void check_world(const Entry& entry, const Step& step, World world) {
  using fault::Name;
  const auto* fault = std::get_if<fault::Fault>(&step.action);
  const bool of_programs = fault && (fault->name == Name::hang || fault->name == Name::crash ||
                                     fault->name == Name::slow || fault->name == Name::babble);
  if (world == World::soak && of_programs)
    entry.find("do")->refuse("CPUs of the soak's world are no programs", "reset, not_reading and resume of them");
  if (world != World::soak && std::holds_alternative<SoakAction>(step.action))
    entry.find("do")->refuse("only the soak's world has that", "world: soak");
}

/// What `rate` may be: in the soak's world lines may take no time.
std::uint64_t rate_of(const Entry& entry, World world) {
  return world == World::soak ? read_rate(entry) : read_line_rate(entry);
}

/// Errors that no single entry shows: unknown sends, lines and inputs that the ring has not, times that run backwards.
void check_scenario(const Entry& file, const Scenario& scenario) {
  const std::vector<std::string> names = send_names(scenario);
  config::Problems problems;
  if (names.size() > kMostNames) file.note(problems, "it has too many sends", std::to_string(kMostNames) + " names");
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
         std::any_of(scenario.steps.begin(), scenario.steps.end(), waits);
}

bool lasts(const Scenario& scenario) { return scenario.world == World::soak || !scenario.steps.empty(); }

namespace {

/// The ring, and what its lines are, before anything that may refer to them is read.
void read_ring(const Entry& file, Scenario& scenario) {
  scenario.ring = ring_of(file);
  if (const auto world = file.find("world")) scenario.world = read_world(*world);
  if (scenario.world == World::soak && file.find("ring"))
    file.find("ring")->refuse("the soak's world has plain nodes", "nodes instead");
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

}  // namespace limb_ring::scenario
