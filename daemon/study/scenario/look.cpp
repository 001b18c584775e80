#include "study/scenario/look.h"

#include <functional>

#include "config/quantity.h"

namespace limb_ring::study::scenario {

namespace {

std::vector<NodeId> those(const Who& who, const Sight& robot) {
  std::vector<NodeId> nodes;
  for (unsigned i = 0; i < robot.size(); ++i) {
    const auto id = static_cast<NodeId>(i);
    if (who.kind == Who::Kind::one && id != who.node) continue;
    if (who.kind == Who::Kind::living && !robot.alive(id)) continue;
    nodes.push_back(id);
  }
  return nodes;
}

std::string none_if_empty(const std::string& text) { return text.empty() ? "nothing of it" : text; }

/// Joins what `say` has to say of each node; "" of one has nothing to say.
std::string list(const std::vector<NodeId>& nodes, const std::function<std::string(NodeId)>& say) {
  std::string text;
  for (const NodeId id : nodes) {
    const std::string words = say(id);
    if (!words.empty()) text += (text.empty() ? "" : "; ") + words;
  }
  return none_if_empty(text);
}

// ---- network controllers --------------------------------------------------------------------

bool holds_at(const NodeIs& node, NodeId id, const Sight& robot) {
  const bool alive = robot.alive(id);
  if (node.down || !alive) return node.down && !alive;
  return (!node.state || robot.state(id) == *node.state) && (!node.ring_size || robot.ring_size(id) == *node.ring_size);
}

std::string state_words(NodeId id, const Sight& robot) {
  if (!robot.alive(id)) return robot.name(id) + " is down";
  return robot.name(id) + " is " + to_string(robot.state(id)) + ", in a ring of " + std::to_string(robot.ring_size(id));
}

bool look_at(const NodeIs& node, const Sight& robot) {
  for (const NodeId id : those(node.who, robot))
    if (!holds_at(node, id, robot)) return false;
  return true;
}

std::string describe(const NodeIs& node, const Sight& robot) {
  const bool one = node.who.kind == Who::Kind::one;
  return list(those(node.who, robot), [&](NodeId id) {
    return one || !holds_at(node, id, robot) ? state_words(id, robot) : std::string();
  });
}

// ---- what beacons have told -----------------------------------------------------------------

std::vector<NodeId> living_others(NodeId not_this, const Sight& robot) {
  std::vector<NodeId> nodes;
  for (const NodeId id : those({Who::Kind::living, 0}, robot))
    if (id != not_this) nodes.push_back(id);
  return nodes;
}

bool look_at(const CpuIs& cpu, const Sight& robot) {
  for (const NodeId id : living_others(cpu.node, robot)) {
    const auto beacon = robot.heard(id, cpu.node);
    if (!beacon) return false;
    if (cpu.state && beacon->cpu_state != *cpu.state) return false;
    if (cpu.boots && beacon->cpu_boots != *cpu.boots) return false;
  }
  return true;
}

std::string describe(const CpuIs& cpu, const Sight& robot) {
  const std::vector<NodeId> told = living_others(cpu.node, robot);
  if (told.empty()) return "nobody else lives";
  const auto beacon = robot.heard(told[0], cpu.node);
  if (!beacon) return robot.name(told[0]) + " has not heard of it";
  return robot.name(told[0]) + " has heard that it is " + to_string(beacon->cpu_state) + " in boot " +
         std::to_string(beacon->cpu_boots);
}

bool knows(NodeId id, const Located& line, const Sight& robot) {
  const auto beacon = robot.heard(id, line.behind);
  return beacon && beacon->break_known && beacon->break_before == line.before && beacon->break_behind == line.behind;
}

bool look_at(const Located& line, const Sight& robot) {
  const std::vector<NodeId> others = living_others(line.behind, robot);
  for (const NodeId id : others)
    if (!knows(id, line, robot)) return false;
  return !others.empty();
}

std::string describe(const Located& line, const Sight& robot) {
  return list(living_others(line.behind, robot), [&](NodeId id) {
    return knows(id, line, robot) ? std::string() : robot.name(id) + " does not know";
  });
}

// ---- counts ---------------------------------------------------------------------------------

std::uint64_t count_of(const Counted& counted, const Sight& robot) {
  std::uint64_t sum = 0;
  for (const NodeId id : those(counted.of, robot)) sum += robot.counter(id, counted.counter);
  return sum;
}

std::uint64_t count_of(const Results& results, const Sight& robot) {
  return robot.tally(results.send).results[static_cast<std::size_t>(results.are)];
}

std::uint64_t count_of(const Taken& taken, const Sight& robot) { return robot.tally(taken.send).taken; }

template <class T>
bool look_at(const T& counted, const Sight& robot) {
  return counted.range.holds(count_of(counted, robot));
}

std::string describe(const Counted& counted, const Sight& robot) { return std::to_string(count_of(counted, robot)); }

std::string describe(const Taken& taken, const Sight& robot) { return std::to_string(count_of(taken, robot)); }

std::string describe(const Results& results, const Sight& robot) {
  const Tally& tally = robot.tally(results.send);
  std::string text;
  for (std::size_t i = 0; i < tally.results.size(); ++i)
    if (tally.results[i] != 0)
      text += (text.empty() ? "" : ", ") + std::to_string(tally.results[i]) + ' ' +
              to_string(static_cast<core::Outcome>(i));
  return none_if_empty(text);
}

bool look_at(const Latency& latency, const Sight& robot) {
  return robot.tally(latency.send).worst <= core::Duration(robot.allowed(latency.at_most));
}

std::string describe(const Latency& latency, const Sight& robot) {
  const core::Duration worst = robot.tally(latency.send).worst;
  return config::format_time(std::chrono::duration_cast<nanoseconds>(worst));
}

}  // namespace

bool holds(const Condition& condition, const Sight& robot) {
  return std::visit([&](const auto& what) { return look_at(what, robot); }, condition.what);
}

std::string seen(const Condition& condition, const Sight& robot) {
  return std::visit([&](const auto& what) { return describe(what, robot); }, condition.what);
}

}  // namespace limb_ring::study::scenario
