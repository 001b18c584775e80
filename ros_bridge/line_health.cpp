#include "ros_bridge/line_health.h"

#include "ros_bridge/node_health.h"

namespace limb_ring::bridge {
namespace {

using diagnostic_updater::DiagnosticStatusWrapper;
using Level = diagnostic_msgs::DiagnosticStatus;

bool is_known(const NodeStatus& node) { return node.input_state == "up" || node.input_state == "down"; }

}  // namespace

LineHealth::LineHealth(const config::NodeConfig& from, const config::NodeConfig& to)
    : from_(from),
      to_(to),
      out_counters_(ask::ErrorCounter::Of::output),
      in_counters_(ask::ErrorCounter::Of::input),
      recent_(kWarnFor) {}

void LineHealth::take(const RingStatus& ring, Clock::time_point now) {
  said_broken_ = false;
  for (const NodeStatus& node : ring.nodes) {
    said_broken_ |= node.broken_before == from_.id && node.broken_behind == to_.id;
    if (node.id == from_.id) note_growth(out_counters_, before_ = node, now);
    if (node.id == to_.id) note_growth(in_counters_, behind_ = node, now);
  }
  const Finding found = finding();
  if (found.level == Level::ERROR) recent_.note("state", "was broken", now);
  if (found.level == Level::WARN) recent_.note("state", "was bypassed", now);
}

void LineHealth::note_growth(CounterGrowth& counters, const NodeStatus& node, Clock::time_point now) {
  for (const auto& step : counters.take(node)) recent_.note(step.name, step.name + " +" + std::to_string(step.by), now);
}

LineHealth::Finding LineHealth::finding() const {
  if (said_broken_) return {Level::ERROR, "broken (or " + from_.name + " does not send)"};
  if (!is_known(before_) && !is_known(behind_)) return {Level::STALE, "neither end is known"};
  // The receiving end knows best. If it is not known (on another host), the sending end tells.
  const bool by_input = is_known(behind_);
  const bool up = by_input ? behind_.input_state == "up" : before_.output_state == "up";
  if (!up) return {Level::ERROR, (by_input ? to_.name + " has no input" : from_.name + " has no output")};
  const int leads = by_input ? behind_.input_from : before_.output_to;
  if (leads == (by_input ? from_.id : to_.id)) return {Level::OK, "up"};
  return {Level::WARN, "bypassed: " + (by_input ? to_.name + " hears node " : from_.name + " sends to node ") +
                           std::to_string(leads)};
}

void LineHealth::tell(DiagnosticStatusWrapper& out, Clock::time_point now) {
  const Finding found = finding();
  out.summary(found.level, found.text);
  if (found.level == Level::OK)
    recent_.each(now, [&](const std::string& text) {
      if (out.level == Level::OK)
        out.summary(Level::WARN, "up; lately: " + text);
      else
        out.mergeSummary(Level::WARN, text);
    });
  out.add("output state", before_.output_state);
  out.add("input state", behind_.input_state);
  out.add("data rate (bit/s)", before_.output_rate);
  for (const std::string& name : out_counters_.names()) out.add(name, counter_of(before_, name));
  for (const std::string& name : in_counters_.names()) out.add(name, counter_of(behind_, name));
}

}  // namespace limb_ring::bridge
