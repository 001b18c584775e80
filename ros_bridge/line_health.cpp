#include "ros_bridge/line_health.h"

#include <algorithm>

#include "ring/reset_node.h"
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

namespace {

constexpr double kShortest = 0.5;  // s between readings: a status at every change tells no rate

std::uint64_t bytes_in(const NodeStatus& node) {
  return ask::line_bytes_in([&node](const char* name) { return counter_of(node, name); });
}

}  // namespace

void LineLoad::take(const RingStatus& ring) {
  for (const NodeStatus& node : ring.nodes) {
    if (node.output_to >= 0) rates_[static_cast<std::uint8_t>(node.output_to)] = node.output_rate;
    const Count now{bytes_in(node), node.pid, ring.header.stamp};
    Count& before = counts_[node.id];
    const double seconds = (now.at - before.at).toSec();
    const bool goes_on = seconds >= 0 && now.pid == before.pid;  // not where a bag is played once more
    if (goes_on && seconds < kShortest) continue;
    if (goes_on && now.pid != 0 && now.bytes >= before.bytes)
      bytes_per_second_[node.id] = static_cast<double>(now.bytes - before.bytes) / seconds;
    else
      bytes_per_second_.erase(node.id);
    before = now;
  }
  busiest_ = 0;
  for (const auto& [end, bytes] : bytes_per_second_) busiest_ = std::max(busiest_, bytes);
}

std::optional<double> LineLoad::of(std::uint8_t end) const {
  const auto bytes = bytes_per_second_.find(end);
  if (bytes == bytes_per_second_.end()) return std::nullopt;
  const auto rate = rates_.find(end);
  if (rate != rates_.end() && rate->second > 0) return std::min(1.0, 8 * bytes->second / rate->second);
  return busiest_ > 0 ? bytes->second / busiest_ : 0;
}

std::uint64_t counter_of(const NodeStatus& node, const std::string& name) {
  const auto& names = node.counter_names;
  const auto place = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  return place < node.counter_values.size() ? node.counter_values[place] : 0;
}

CounterGrowth::CounterGrowth(ask::ErrorCounter::Of of) {
  for (const ask::ErrorCounter& counter : ask::error_counters())
    if (counter.of == of) names_.push_back(counter.name);
}

std::vector<CounterGrowth::Step> CounterGrowth::take(const NodeStatus& node) {
  std::vector<Step> grown;
  if (node.pid == 0) return grown;  // nobody says
  const bool first = pid_ == 0, restarted = node.pid != pid_;
  pid_ = node.pid;
  for (const std::string& name : names_) {
    const std::uint64_t now = counter_of(node, name);
    const std::uint64_t before = restarted ? 0 : last_[name];
    if (!first && now > before) grown.push_back({name, now - before, now});
    last_[name] = now;
  }
  return grown;
}

}  // namespace limb_ring::bridge
