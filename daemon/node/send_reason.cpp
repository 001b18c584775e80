#include "node/send_reason.h"

#include "config/core_settings.h"
#include "config/watchdog.h"

namespace limb_ring::runtime {
namespace {

using core::Outcome;
using core::Reject;

static_assert(static_cast<int>(Reject::bad_size) == static_cast<int>(Reason::bad_size) &&
                  static_cast<int>(Reject::queue_full) == static_cast<int>(Reason::queue_full) &&
                  static_cast<int>(Reject::no_way_out) == static_cast<int>(Reason::no_way_out),
              "core and client library count what is rejected alike");

SendReason plain(Reason reason) { return {reason, sentence(reason)}; }

Reason reason_of_cpu(wire::CpuState state) {
  switch (state) {
    case wire::CpuState::absent:
      return Reason::cpu_absent;
    case wire::CpuState::booting:
      return Reason::cpu_booting;
    case wire::CpuState::failed:
      return Reason::cpu_failed;
    case wire::CpuState::silent:
      return Reason::cpu_silent;
    case wire::CpuState::none:
    case wire::CpuState::running:
      break;
  }
  return Reason::no_buffer;
}

Reason by_beacon(const core::Peer& peer) {
  return peer.beacon_heard ? reason_of_cpu(peer.beacon.cpu_state) : Reason::joining;
}

SendReason probably(Reason reason, const std::string& who) {
  return {reason, "probably " + who + sentence(reason) + " (by its last beacon)"};
}

static_assert(static_cast<int>(core::Outcome::cancelled) == static_cast<int>(limb_ring::Outcome::cancelled) &&
                  static_cast<int>(core::Outcome::lost) == static_cast<int>(limb_ring::Outcome::lost),
              "core and client library count outcomes alike");

}  // namespace

SendReason SendReasons::of(const core::SendEnded& ended) const {
  switch (ended.outcome) {
    case Outcome::delivered:
      return {};
    case Outcome::refused:
      return ended.interrupt ? refused_interrupt(ended) : refused_data(ended);
    case Outcome::no_such_node:
      return plain(Reason::node_missing);
    case Outcome::lost:
      return plain(Reason::no_return);
    case Outcome::unconfirmed:
      return unconfirmed(ended);
    case Outcome::cancelled:
      return plain(Reason::given_up);
    case Outcome::rejected:
      break;
  }
  return rejected(ended);
}

SendReason SendReasons::refused_data(const core::SendEnded& ended) const {
  if (ended.destination == wire::kBroadcast) return refused_by_some();
  if (ended.destination == self_.id) return plain(reason_of_cpu(cpu_.status().state));
  return probably(by_beacon(membership().peers()[ended.destination]), "");
}

/// One node that does not take a broadcast is enough. We name the first node whose beacon shows a reason; if none
/// does, some node's receive buffers must be full.
SendReason SendReasons::refused_by_some() const {
  for (const config::NodeConfig& node : ring_.nodes) {
    const core::Peer& peer = membership().peers()[wire::NodeId{node.id}];
    if (node.id == self_.id || !peer.known) continue;
    if (const Reason reason = by_beacon(peer); reason != Reason::no_buffer)
      return probably(reason, "at " + node.name + ": ");
  }
  return {Reason::no_buffer, "probably some node's receive buffers are full (all their CPUs run)"};
}

SendReason SendReasons::refused_interrupt(const core::SendEnded& ended) const {
  const std::string pin = "INT" + std::to_string(ended.factor);
  if (ended.destination != wire::kBroadcast)
    return {Reason::pin_unwired, "pin " + pin + " of " + name_of(ended.destination) + " is wired to nothing"};
  for (const config::NodeConfig& node : ring_.nodes)
    if (node.pins[ended.factor].action == config::PinConfig::Action::none)
      return {Reason::pin_unwired, "pin " + pin + " is wired to nothing at " + node.name};
  return {Reason::pin_unwired, "pin " + pin + " is wired to nothing at some node"};
}

SendReason SendReasons::unconfirmed(const core::SendEnded& ended) const {
  const auto broken = membership().broken_line();
  if (!broken) return plain(Reason::open_chain);
  const std::string line = " (line " + name_of(broken->before) + " -> " + name_of(broken->behind) + " is broken)";
  const bool reaches =
      ended.destination == wire::kBroadcast ||
      watchdog::reach_of(setup::order_of(ring_), broken, wire::NodeId{self_.id}, ended.destination).sends;
  const Reason reason = reaches ? Reason::open_chain : Reason::out_of_reach;
  return {reason, sentence(reason) + line};
}

SendReason SendReasons::rejected(const core::SendEnded& ended) const {
  const auto reason = static_cast<Reason>(ended.reject);
  if (reason != Reason::not_in_ring) return plain(reason);
  return {reason, std::string(sentence(reason)) + " (it is " + to_string(membership().state()) + ")"};
}

std::string SendReasons::name_of(wire::NodeId id) const {
  const config::NodeConfig* node = ring_.find(id);
  return node ? node->name : "node " + std::to_string(id);
}

limb_ring::Outcome public_outcome(core::Outcome outcome) { return static_cast<limb_ring::Outcome>(outcome); }

}  // namespace limb_ring::runtime
