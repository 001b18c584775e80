#include "scenario/conditions.h"

#include <functional>

#include "config/quantity.h"

namespace limb_ring::scenario {

namespace {

std::vector<NodeId> those(const Who& who, const Sight& sight) {
  std::vector<NodeId> nodes;
  for (unsigned i = 0; i < sight.size(); ++i) {
    const auto id = static_cast<NodeId>(i);
    if (who.kind == Who::Kind::one && id != who.node) continue;
    if (who.kind == Who::Kind::living && !sight.alive(id)) continue;
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

bool holds_at(const NodeIs& node, NodeId id, const Sight& sight) {
  const bool alive = sight.alive(id);
  if (node.down || !alive) return node.down && !alive;
  return (!node.state || sight.state(id) == *node.state) && (!node.ring_size || sight.ring_size(id) == *node.ring_size);
}

std::string state_words(NodeId id, const Sight& sight) {
  if (!sight.alive(id)) return sight.name(id) + " is down";
  return sight.name(id) + " is " + to_string(sight.state(id)) + ", in a ring of " + std::to_string(sight.ring_size(id));
}

bool holds_now(const NodeIs& node, const Sight& sight) {
  for (const NodeId id : those(node.who, sight))
    if (!holds_at(node, id, sight)) return false;
  return true;
}

std::string describe(const NodeIs& node, const Sight& sight) {
  const bool one = node.who.kind == Who::Kind::one;
  return list(those(node.who, sight),
              [&](NodeId id) { return one || !holds_at(node, id, sight) ? state_words(id, sight) : std::string(); });
}

// ---- what beacons have told -----------------------------------------------------------------

std::vector<NodeId> living_others(NodeId not_this, const Sight& sight) {
  std::vector<NodeId> nodes;
  for (const NodeId id : those({Who::Kind::living, {}}, sight))
    if (id != not_this) nodes.push_back(id);
  return nodes;
}

bool holds_now(const CpuIs& cpu, const Sight& sight) {
  for (const NodeId id : living_others(cpu.node, sight)) {
    const auto beacon = sight.heard(id, cpu.node);
    if (!beacon) return false;
    if (cpu.state && beacon->cpu_state != *cpu.state) return false;
    if (cpu.boots && beacon->cpu_boots != *cpu.boots) return false;
  }
  return true;
}

std::string describe(const CpuIs& cpu, const Sight& sight) {
  const std::vector<NodeId> told = living_others(cpu.node, sight);
  if (told.empty()) return "nobody else lives";
  const auto beacon = sight.heard(told[0], cpu.node);
  if (!beacon) return sight.name(told[0]) + " has not heard of it";
  return sight.name(told[0]) + " has heard that it is " + to_string(beacon->cpu_state) + " in boot " +
         std::to_string(beacon->cpu_boots);
}

bool knows(NodeId id, const Located& line, const Sight& sight) {
  const auto beacon = sight.heard(id, line.behind);
  return beacon && beacon->break_known && beacon->break_before == line.before && beacon->break_behind == line.behind;
}

bool holds_now(const Located& line, const Sight& sight) {
  const std::vector<NodeId> others = living_others(line.behind, sight);
  for (const NodeId id : others)
    if (!knows(id, line, sight)) return false;
  return !others.empty();
}

std::string describe(const Located& line, const Sight& sight) {
  return list(living_others(line.behind, sight),
              [&](NodeId id) { return knows(id, line, sight) ? std::string() : sight.name(id) + " does not know"; });
}

// ---- counts ---------------------------------------------------------------------------------

std::uint64_t count_of(const Counted& counted, const Sight& sight) {
  std::uint64_t sum = 0;
  for (const NodeId id : those(counted.of, sight)) sum += sight.counter(id, counted.counter);
  return sum;
}

std::uint64_t count_of(const Results& results, const Sight& sight) {
  return sight.tally(results.send).results[static_cast<std::size_t>(results.are)];
}

std::uint64_t count_of(const Taken& taken, const Sight& sight) { return sight.tally(taken.send).taken; }

template <class T>
bool holds_now(const T& counted, const Sight& sight) {
  return counted.range.holds(count_of(counted, sight));
}

std::string describe(const Counted& counted, const Sight& sight) { return std::to_string(count_of(counted, sight)); }

std::string describe(const Taken& taken, const Sight& sight) { return std::to_string(count_of(taken, sight)); }

std::string describe(const Results& results, const Sight& sight) {
  const Tally& tally = sight.tally(results.send);
  std::string text;
  for (std::size_t i = 0; i < tally.results.size(); ++i)
    if (tally.results[i] != 0)
      text += (text.empty() ? "" : ", ") + std::to_string(tally.results[i]) + ' ' +
              to_string(static_cast<core::Outcome>(i));
  return none_if_empty(text);
}

bool holds_now(const Latency& latency, const Sight& sight) {
  return sight.tally(latency.send).worst <= core::Duration(sight.allowed(latency.at_most));
}

std::string describe(const Latency& latency, const Sight& sight) {
  const core::Duration worst = sight.tally(latency.send).worst;
  return config::format_time(std::chrono::duration_cast<nanoseconds>(worst));
}

}  // namespace

bool holds(const Condition& condition, const Sight& sight) {
  return std::visit([&](const auto& what) { return holds_now(what, sight); }, condition.what);
}

std::string seen(const Condition& condition, const Sight& sight) {
  return std::visit([&](const auto& what) { return describe(what, sight); }, condition.what);
}

}  // namespace limb_ring::scenario
