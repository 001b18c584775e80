#include "ros_bridge/joint_store.h"

#include <algorithm>

namespace limb_ring::bridge {
namespace {

// A state that comes so many numbers later is from a CPU that has restarted: at 100 Hz this
// is ten seconds, long after the node was called silent.
constexpr std::uint16_t kRestart = 1000;

std::uint16_t skipped_between(std::uint16_t last, std::uint16_t now) {
  return static_cast<std::uint16_t>(now - last - 1);
}

std::uint64_t missing_between(std::uint16_t last, std::uint16_t now) {
  const std::uint16_t skipped = skipped_between(last, now);
  return skipped < kRestart ? skipped : 0;
}

/// The count wraps, and a CPU that has restarted counts from 0.
std::uint64_t refused_between(const payload::JointState& last, const payload::JointState& now) {
  if (skipped_between(last.sequence, now.sequence) >= kRestart && now.refused < last.refused) return now.refused;
  return static_cast<std::uint16_t>(now.refused - last.refused);
}

JointStore::Clock::duration three_periods(double rate) {
  return std::chrono::duration_cast<JointStore::Clock::duration>(std::chrono::duration<double>(3 / rate));
}

}  // namespace

JointStore::JointStore(const config::RingConfig& ring)
    : silence_(three_periods(ring.firmware.state_rate)), followers_(ring.followers) {
  for (const auto& config : ring.nodes) {
    if (config.joints.empty()) continue;
    order_.push_back(config.id);
    auto& names = nodes_[config.id].joints;
    for (const auto& joint : config.joints) names.push_back(joint.name);
  }
}

bool JointStore::take(std::uint8_t id, const payload::JointState& state, Clock::time_point now) {
  const auto found = nodes_.find(id);
  if (found == nodes_.end() || found->second.joints.size() != state.joints.size()) return false;
  Node& node = found->second;
  if (node.heard) {
    node.received.missing += missing_between(node.state.sequence, state.sequence);
    node.received.refused += refused_between(node.state, state);
  }
  node.heard = true;
  node.arrived = now;
  node.state = state;
  ++node.received.states;
  node.received.stopped = state.mode.stopped;
  return true;
}

void JointStore::forget() {
  for (auto& [id, node] : nodes_) node.heard = false;
}

bool JointStore::is_fresh(const Node& node, Clock::time_point now, Clock::duration pause) const {
  return node.heard && now - node.arrived <= std::max(silence_, pause);
}

JointStore::Snapshot JointStore::snapshot(Clock::time_point now, Clock::duration pause) const {
  Snapshot snapshot;
  for (const auto id : order_) {
    const Node& node = nodes_.at(id);
    if (!is_fresh(node, now, pause)) {
      snapshot.silent.insert(snapshot.silent.end(), node.joints.begin(), node.joints.end());
      continue;
    }
    const bool first = snapshot.fresh.empty();
    snapshot.oldest_stamp_ns = first ? node.state.stamp_ns : std::min(snapshot.oldest_stamp_ns, node.state.stamp_ns);
    snapshot.samples.push_back({id, node.state.stamp_ns});
    for (std::size_t i = 0; i < node.joints.size(); ++i)
      snapshot.fresh.push_back({node.joints[i], node.state.joints[i]});
  }
  add_followers(snapshot);
  return snapshot;
}

/// They have no motor, so no effort. One whose leader is silent is silent with it.
void JointStore::add_followers(Snapshot& snapshot) const {
  if (followers_.empty()) return;
  std::map<std::string, payload::JointState::Joint> leaders;
  for (const Joint& joint : snapshot.fresh) leaders[joint.name] = joint.state;
  for (const auto& follower : followers_) {
    const auto leader = leaders.find(follower.leader);
    if (leader == leaders.end())
      snapshot.silent.push_back(follower.name);
    else
      snapshot.fresh.push_back({follower.name,
                                {follower.multiplier * leader->second.position + follower.offset,
                                 follower.multiplier * leader->second.velocity, 0}});
  }
}

bool JointStore::speaks(std::uint8_t id, Clock::time_point now, Clock::duration pause) const {
  const auto found = nodes_.find(id);
  return found != nodes_.end() && is_fresh(found->second, now, pause);
}

JointStore::Received JointStore::received(std::uint8_t id) const {
  const auto found = nodes_.find(id);
  return found == nodes_.end() ? Received{} : found->second.received;
}

}  // namespace limb_ring::bridge
