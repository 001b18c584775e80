#include "study/scenario/look.h"

#include <functional>

#include "config/quantity.h"

namespace limb_ring::study::scenario {

namespace {

std::vector<NodeId> those(const Who& who, const Robot& robot) {
  std::vector<NodeId> nodes;
  for (unsigned i = 0; i < robot.ring().size(); ++i) {
    const auto id = static_cast<NodeId>(i);
    if (who.kind == Who::Kind::one && id != who.node) continue;
    if (who.kind == Who::Kind::living && !robot.ring().alive(id)) continue;
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

bool holds_at(const NodeIs& node, NodeId id, const Robot& robot) {
  const bool alive = robot.ring().alive(id);
  if (node.down || !alive) return node.down && !alive;
  const core::Membership& member = robot.membership(id);
  return (!node.state || member.state() == *node.state) && (!node.ring_size || member.ring_size() == *node.ring_size);
}

std::string state_words(NodeId id, const Robot& robot) {
  if (!robot.ring().alive(id)) return robot.name(id) + " is down";
  const core::Membership& member = robot.membership(id);
  return robot.name(id) + " is " + to_string(member.state()) + ", in a ring of " + std::to_string(member.ring_size());
}

bool look_at(const NodeIs& node, const Robot& robot) {
  for (const NodeId id : those(node.who, robot))
    if (!holds_at(node, id, robot)) return false;
  return true;
}

std::string describe(const NodeIs& node, const Robot& robot) {
  const bool one = node.who.kind == Who::Kind::one;
  return list(those(node.who, robot), [&](NodeId id) {
    return one || !holds_at(node, id, robot) ? state_words(id, robot) : std::string();
  });
}

// ---- what beacons have told -----------------------------------------------------------------

std::vector<NodeId> living_others(NodeId not_this, const Robot& robot) {
  std::vector<NodeId> nodes;
  for (const NodeId id : those({Who::Kind::living, 0}, robot))
    if (id != not_this) nodes.push_back(id);
  return nodes;
}

bool look_at(const CpuIs& cpu, const Robot& robot) {
  for (const NodeId id : living_others(cpu.node, robot)) {
    const core::Peer& peer = robot.membership(id).peers()[cpu.node];
    if (!peer.beacon_heard) return false;
    if (cpu.state && peer.beacon.cpu_state != *cpu.state) return false;
    if (cpu.boots && peer.beacon.cpu_boots != *cpu.boots) return false;
  }
  return true;
}

std::string describe(const CpuIs& cpu, const Robot& robot) {
  const std::vector<NodeId> told = living_others(cpu.node, robot);
  if (told.empty()) return "nobody else lives";
  const core::Peer& peer = robot.membership(told[0]).peers()[cpu.node];
  if (!peer.beacon_heard) return robot.name(told[0]) + " has not heard of it";
  return robot.name(told[0]) + " has heard that it is " + to_string(peer.beacon.cpu_state) + " in boot " +
         std::to_string(peer.beacon.cpu_boots);
}

bool knows(NodeId id, const Located& line, const Robot& robot) {
  const core::Peer& peer = robot.membership(id).peers()[line.behind];
  return peer.beacon_heard && peer.beacon.break_known && peer.beacon.break_before == line.before &&
         peer.beacon.break_behind == line.behind;
}

bool look_at(const Located& line, const Robot& robot) {
  const std::vector<NodeId> others = living_others(line.behind, robot);
  for (const NodeId id : others)
    if (!knows(id, line, robot)) return false;
  return !others.empty();
}

std::string describe(const Located& line, const Robot& robot) {
  return list(living_others(line.behind, robot), [&](NodeId id) {
    return knows(id, line, robot) ? std::string() : robot.name(id) + " does not know";
  });
}

// ---- counts ---------------------------------------------------------------------------------

std::uint64_t count_of(const Counted& counted, const Robot& robot) {
  std::uint64_t sum = 0;
  for (const NodeId id : those(counted.of, robot))
    robot.ring().counters(id).each([&](const char* name, const char*, std::uint64_t value) {
      if (counted.counter == name) sum += value;
    });
  return sum;
}

std::uint64_t count_of(const Results& results, const Robot& robot) {
  return robot.senders().tally(results.send).results[static_cast<std::size_t>(results.are)];
}

std::uint64_t count_of(const Taken& taken, const Robot& robot) { return robot.senders().tally(taken.send).taken; }

template <class T>
bool look_at(const T& counted, const Robot& robot) {
  return counted.range.holds(count_of(counted, robot));
}

std::string describe(const Counted& counted, const Robot& robot) { return std::to_string(count_of(counted, robot)); }

std::string describe(const Taken& taken, const Robot& robot) { return std::to_string(count_of(taken, robot)); }

std::string describe(const Results& results, const Robot& robot) {
  const Tally& tally = robot.senders().tally(results.send);
  std::string text;
  for (std::size_t i = 0; i < tally.results.size(); ++i)
    if (tally.results[i] != 0)
      text += (text.empty() ? "" : ", ") + std::to_string(tally.results[i]) + ' ' +
              to_string(static_cast<core::Outcome>(i));
  return none_if_empty(text);
}

bool look_at(const Latency& latency, const Robot& robot) {
  return robot.senders().tally(latency.send).worst <= core::Duration(latency.at_most);
}

std::string describe(const Latency& latency, const Robot& robot) {
  const core::Duration worst = robot.senders().tally(latency.send).worst;
  return config::format_time(std::chrono::duration_cast<nanoseconds>(worst));
}

}  // namespace

bool holds(const Condition& condition, const Robot& robot) {
  return std::visit([&](const auto& what) { return look_at(what, robot); }, condition.what);
}

std::string seen(const Condition& condition, const Robot& robot) {
  return std::visit([&](const auto& what) { return describe(what, robot); }, condition.what);
}

}  // namespace limb_ring::study::scenario
