#include "sim/only_virtual.h"

#include "config/fault_name.h"
#include "config/quantity.h"

namespace limb_ring::scenario {

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
}

}  // namespace

Reasons only_virtual(const Scenario& scenario, const std::string& transport) {
  Reasons reasons;
  if (scenario.only_sim) reasons.emplace_back("only: sim");
  if (scenario.world == World::soak) reasons.emplace_back("world: soak");
  for (const Step& step : scenario.steps) judge(scenario, step, transport, reasons);
  for (const auto* conditions : {&scenario.always, &scenario.never})
    for (const Condition& condition : *conditions) judge(scenario, condition, reasons);
  return reasons;
}

}  // namespace limb_ring::scenario
