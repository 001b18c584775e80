#include "runtime/send_reason.h"

#include "setup/core_settings.h"
#include "watchdog/reach.h"

namespace limb_ring::runtime {
namespace {

using core::Outcome;
using core::Reject;

static_assert(static_cast<int>(Reject::bad_size) == static_cast<int>(Reason::bad_size) &&
                  static_cast<int>(Reject::queue_full) == static_cast<int>(Reason::queue_full) &&
                  static_cast<int>(Reject::no_way_out) == static_cast<int>(Reason::no_way_out),
              "core and client library count what is rejected alike");

SendReason plain(Reason reason) { return {reason, sentence(reason)}; }

std::string name_of(const config::RingConfig& ring, wire::NodeId id) {
  const config::NodeConfig* node = ring.find(id);
  return node ? node->name : "node " + std::to_string(id);
}

Reason reason_of_cpu(wire::CpuState state) {
  switch (state) {
    case wire::CpuState::absent: return Reason::cpu_absent;
    case wire::CpuState::booting: return Reason::cpu_booting;
    case wire::CpuState::failed: return Reason::cpu_failed;
    case wire::CpuState::silent: return Reason::cpu_silent;
    case wire::CpuState::none:
    case wire::CpuState::running: break;
  }
  return Reason::no_buffer;
}

Reason by_beacon(const core::Peer& peer) {
  return peer.beacon_heard ? reason_of_cpu(peer.beacon.cpu_state) : Reason::joining;
}

SendReason probably(Reason reason, const std::string& who) {
  return {reason, "probably " + who + sentence(reason) + " (by its last beacon)"};
}

/// One node that does not take it is enough: the first whose beacon shows a reason, else some node's buffers.
SendReason refused_by_some(const config::RingConfig& ring, const config::NodeConfig& own,
                           const core::Membership& membership) {
  for (const config::NodeConfig& node : ring.nodes) {
    const core::Peer& peer = membership.peers()[node.id];
    if (node.id == own.id || !peer.known) continue;
    if (const Reason reason = by_beacon(peer); reason != Reason::no_buffer)
      return probably(reason, "at " + node.name + ": ");
  }
  return {Reason::no_buffer, "probably some node's receive buffers are full (all their CPUs run)"};
}

SendReason refused_data(const core::SendEnded& ended, const config::RingConfig& ring, const config::NodeConfig& own,
                        wire::CpuState own_cpu, const core::Membership& membership) {
  if (ended.destination == wire::kBroadcast) return refused_by_some(ring, own, membership);
  if (ended.destination == own.id) return plain(reason_of_cpu(own_cpu));
  return probably(by_beacon(membership.peers()[ended.destination]), "");
}

SendReason refused_interrupt(const core::SendEnded& ended, const config::RingConfig& ring) {
  const std::string pin = "INT" + std::to_string(ended.factor);
  if (ended.destination != wire::kBroadcast)
    return {Reason::pin_unwired, "pin " + pin + " of " + name_of(ring, ended.destination) + " is wired to nothing"};
  for (const config::NodeConfig& node : ring.nodes)
    if (node.pins[ended.factor].action == config::PinConfig::Action::none)
      return {Reason::pin_unwired, "pin " + pin + " is wired to nothing at " + node.name};
  return {Reason::pin_unwired, "pin " + pin + " is wired to nothing at some node"};
}

SendReason unconfirmed(const core::SendEnded& ended, const config::RingConfig& ring, const config::NodeConfig& own,
                       const core::Membership& membership) {
  const auto broken = membership.broken_line();
  if (!broken) return plain(Reason::open_chain);
  const std::string line =
      " (line " + name_of(ring, broken->before) + " -> " + name_of(ring, broken->behind) + " is broken)";
  const bool reaches = ended.destination == wire::kBroadcast ||
                       watchdog::reach_of(setup::order_of(ring), broken, own.id, ended.destination).sends;
  const Reason reason = reaches ? Reason::open_chain : Reason::out_of_reach;
  return {reason, sentence(reason) + line};
}

}  // namespace

SendReason reason_of(const core::SendEnded& ended, const config::RingConfig& ring, const config::NodeConfig& own,
                     wire::CpuState own_cpu, const core::Membership& membership) {
  switch (ended.outcome) {
    case Outcome::delivered: return {};
    case Outcome::refused:
      return ended.interrupt ? refused_interrupt(ended, ring) : refused_data(ended, ring, own, own_cpu, membership);
    case Outcome::no_such_node: return plain(Reason::node_missing);
    case Outcome::lost: return plain(Reason::no_return);
    case Outcome::unconfirmed: return unconfirmed(ended, ring, own, membership);
    case Outcome::cancelled: return plain(Reason::given_up);
    case Outcome::rejected: break;
  }
  const auto reason = static_cast<Reason>(ended.reject);
  if (reason != Reason::not_in_ring) return plain(reason);
  return {reason, std::string(sentence(reason)) + " (it is " + to_string(membership.state()) + ")"};
}

}  // namespace limb_ring::runtime
