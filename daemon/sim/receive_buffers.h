#pragma once

#include <array>
#include <deque>

#include "sim/ledger.h"

namespace limb_ring::sim {

/// What lies in the receive buffers of one node, as can be told from outside, and whether its CPU gets that, the
/// highest priority first and in order within one. (protocol.md section 2.3)
class ReceiveBuffers {
 public:
  ReceiveBuffers(NodeId node, Ledger& ledger, const Complain& complain)
      : node_(node), ledger_(ledger), complain_(complain) {}

  /// A packet was taken. @param sent null: not asked for through the ring. @param at its last bit was in
  void put(const Sent* sent, NodeId source, std::uint8_t priority, Time at);
  /// The CPU reads one.
  void read(const core::ReceivedPacket& packet, Time now);
  /// The CPU was reset, or the node restarted: all of it is gone.
  void flush();

 private:
  struct Unread {
    NodeId source;
    std::uint32_t token;  ///< 0: not asked for through the ring
    Time at;
  };
  void check_priority(const core::ReceivedPacket& packet, Time now) const;

  NodeId node_;
  Ledger& ledger_;
  const Complain& complain_;
  std::array<std::deque<Unread>, 4> unread_;  ///< by priority
};

}  // namespace limb_ring::sim
