#include "sim/scenario_report.h"

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <locale>
#include <sstream>

#include "config/fault.h"
#include "config/quantity.h"
#include "config/urdf_joints.h"

namespace limb_ring::scenario {
namespace {

std::ostringstream plain_stream() {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << std::fixed;
  return out;
}

std::string milliseconds(nanoseconds time) {
  std::ostringstream out = plain_stream();
  out << std::setw(12) << time.count() / 1000000 << '.' << std::setfill('0') << std::setw(6) << time.count() % 1000000;
  return out.str() + " ms";
}

std::string seconds(nanoseconds time) {
  std::ostringstream out = plain_stream();
  out << time.count() / 1000000000 << '.' << std::setfill('0') << std::setw(9) << time.count() % 1000000000;
  return out.str();
}

/// Below the times.
std::string trace_line(const ScenarioRun& run) {
  if (!run.trace) return "";
  const std::string why = run.trace->not_repeatable.empty() ? "" : "; not repeatable: " + run.trace->not_repeatable;
  return std::string(milliseconds(nanoseconds{0}).size() + 2, ' ') + "trace hash " + run.trace->hash + why + '\n';
}

std::string begin_of_case(const std::string& path, const std::string& name, nanoseconds lasted) {
  const std::string file = std::filesystem::path(path).stem().string();
  return "    <testcase classname=\"scenarios\" name=\"" + config::xml_text(file + ": " + name) + "\" time=\"" +
         seconds(lasted) + "\">\n";
}

std::string test_case(const ScenarioRun& run) {
  std::string text = begin_of_case(run.path, run.name, run.lasted);
  if (run.unmet)
    text += "      <failure message=\"" +
            config::xml_text("expected: " + run.unmet->expected + "; seen: " + run.unmet->seen) + "\"/>\n";
  return text + "      <system-out>" + config::xml_text(text_of(run)) + "</system-out>\n    </testcase>\n";
}

std::string case_without_run(const Scenario& scenario, const std::string& element, const std::string& why) {
  return begin_of_case(scenario.path, scenario.name, nanoseconds{0}) + "      <" + element + " message=\"" +
         config::xml_text(why) + "\"/>\n    </testcase>\n";
}

}  // namespace

std::string text_of(const ScenarioRun& run) {
  const std::string where = run.live ? "live, " : run.trace ? "virtual, " : "";
  const std::string order = run.order == 0 ? "" : ", order " + std::to_string(run.order);
  std::string text = run.path + ": " + run.name + " (" + where + "seed " + std::to_string(run.seed) + order + ")\n";
  for (const LogLine& line : run.log) text += milliseconds(line.at) + "  " + line.what.words + '\n';
  if (!run.unmet) return text + milliseconds(run.lasted) + "  end: all as expected\n" + trace_line(run);
  const std::string indent(milliseconds(run.lasted).size() + 2, ' ');
  return text + milliseconds(run.unmet->at) + "  NOT as expected: " + run.unmet->expected + '\n' + indent +
         "seen instead: " + run.unmet->seen + '\n' + trace_line(run);
}

std::string junit_of(const std::vector<ScenarioRun>& runs, const std::vector<Scenario>& scenarios,
                     const std::string& stopped) {
  const std::size_t tests = std::max(runs.size(), scenarios.size());
  const std::size_t errors = runs.size() < tests ? 1 : 0;
  nanoseconds all{0};
  for (const ScenarioRun& run : runs) all += run.lasted;
  const auto failures =
      std::count_if(runs.begin(), runs.end(), [](const ScenarioRun& run) { return run.unmet.has_value(); });
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite name=\"scenarios\"";
  text += " tests=\"" + std::to_string(tests) + "\" failures=\"" + std::to_string(failures) + "\"";
  text += " errors=\"" + std::to_string(errors) + "\" skipped=\"" + std::to_string(tests - runs.size() - errors) + "\"";
  text += " time=\"" + seconds(all) + "\">\n";
  for (const ScenarioRun& run : runs) text += test_case(run);
  for (std::size_t i = runs.size(); i < tests; ++i)
    text += i == runs.size() ? case_without_run(scenarios[i], "error", stopped)
                             : case_without_run(scenarios[i], "skipped", "not run");
  return text + "  </testsuite>\n</testsuites>\n";
}

namespace {

using Reasons = std::vector<std::string>;

/// An action takes a request to a daemon and its answer.
constexpr std::chrono::milliseconds kShortestStep{1};

bool is_udp(const Scenario& scenario, NodeId line, const std::string& transport) {
  if (!transport.empty()) return transport == "udp";
  const auto& behind = scenario.ring.nodes[(line + 1u) % scenario.ring.nodes.size()];
  return behind.link.transport == config::LinkConfig::Transport::udp;
}

void judge(const Scenario& scenario, const Condition& condition, Reasons& reasons) {
  const auto* results = std::get_if<Results>(&condition.what);
  if (results && results->are == core::Outcome::cancelled)
    reasons.push_back(condition.words + ": live a tool sends for the CPU, and its sends outlive a reset");
  const auto* counted = std::get_if<Counted>(&condition.what);
  if (counted && counted->counter == "embedded_interrupts" && counted->range.at_least && scenario.rates_assumed)
    reasons.push_back(condition.words + ": live, lines without a rate carry packets whole");
}

void judge(const Scenario& scenario, const Step& step, const std::string& transport, Reasons& reasons) {
  if (step.after && step.after->count() != 0 && *step.after < kShortestStep)
    reasons.push_back("after: " + config::format_time(*step.after) + ": live, a step takes milliseconds");
  if (step.when) judge(scenario, *step.when, reasons);
  const auto* action = std::get_if<Fault>(&step.action);
  if (action && action->name == fault::Name::reorder && !is_udp(scenario, action->nodes[0], transport))
    reasons.push_back(step.words +
                      ": UNIX streams and shared memory keep order; with --transport udp it can be had live");
  if (action && action->name == fault::Name::step_clock)
    reasons.push_back(step.words + ": live, the clocks are those of the machine");
}

}  // namespace

Reasons only_virtual(const Scenario& scenario, const std::string& transport) {
  Reasons reasons;
  if (scenario.only_sim) reasons.emplace_back("only: sim");
  if (scenario.world == World::soak) reasons.emplace_back("world: soak");
  if (!scenario.clocks.empty()) reasons.emplace_back("clocks: live, all nodes of a host have its clock");
  if (!scenario.sometimes.empty()) reasons.emplace_back("sometimes: live, nobody sees every packet of every line");
  for (const Step& step : scenario.steps) judge(scenario, step, transport, reasons);
  for (const auto* conditions : {&scenario.always, &scenario.never})
    for (const Condition& condition : *conditions) judge(scenario, condition, reasons);
  return reasons;
}

}  // namespace limb_ring::scenario
