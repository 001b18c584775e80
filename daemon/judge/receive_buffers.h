#pragma once

#include <array>
#include <deque>

#include "judge/ledger.h"

namespace limb_ring::sim {

/// What lies in the receive buffers of one node, as far as can be told from outside. Checks that its CPU gets that, the
/// highest priority first and in order within one. (protocol.md section 2.3)
class ReceiveBuffers {
 public:
  ReceiveBuffers(NodeId node, Ledger& ledger, const Complain& complain)
      : node_(node), ledger_(ledger), complain_(complain) {}

  /// A packet was taken. @param sent null: not asked for through the ring. @param at its last bit was in
  /// @param sure false: perhaps it was not taken
  void put(Sent* sent, NodeId source, std::uint8_t priority, Time at, bool sure);
  /// Packets of that priority in it, at least and at most.
  std::size_t least(std::uint8_t priority) const { return unread_[priority].size() - doubtful_[priority]; }
  std::size_t most(std::uint8_t priority) const { return unread_[priority].size(); }
  /// The CPU reads one.
  void read(const core::ReceivedPacket& packet, Time now);
  /// The CPU was reset, or the node restarted: all of it is gone.
  void flush();
  template <class Archive>
  void archive(Archive& a) {
    a("unread", unread_)("doubtful", doubtful_);
  }

 private:
  struct Unread {
    NodeId source;
    std::uint32_t token;  ///< 0: not asked for through the ring
    Time at;
    bool sure;

    template <class Archive>
    void archive(Archive& a) {
      a("source", source)("token", token)("at", at)("sure", sure);
    }
  };
  void check_priority(const core::ReceivedPacket& packet, Time now) const;
  void drop_front(std::uint8_t priority);
  bool may_be(const Unread& unread, const core::ReceivedPacket& packet) const;
  void never_took(const core::ReceivedPacket& packet) const;

  NodeId node_;
  Ledger& ledger_;
  const Complain& complain_;
  std::array<std::deque<Unread>, 4> unread_;  ///< by priority
  std::array<std::size_t, 4> doubtful_{};     ///< of them
};

}  // namespace limb_ring::sim
