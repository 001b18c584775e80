#include "judge/receive_buffers.h"

#include <algorithm>

namespace limb_ring::sim {

void ReceiveBuffers::put(Sent* sent, NodeId source, std::uint8_t priority, Time at, bool sure) {
  unread_[priority].push_back({source, sent ? sent->token : 0, at, sure});
  if (!sure) ++doubtful_[priority];
  if (sent) ++sent->unread;
}

void ReceiveBuffers::drop_front(std::uint8_t priority) {
  const Unread& front = unread_[priority].front();
  if (!front.sure) --doubtful_[priority];
  if (Sent* sent = ledger_.find(front.source, front.token)) --sent->unread;
  unread_[priority].pop_front();
}

bool ReceiveBuffers::may_be(const Unread& unread, const core::ReceivedPacket& packet) const {
  const Sent* sent = ledger_.find(unread.source, unread.token);
  return sent ? sent->is(packet) : unread.source == packet.source;
}

void ReceiveBuffers::read(const core::ReceivedPacket& packet, Time now) {
  check_priority(packet, now);
  auto& unread = unread_[packet.priority];
  const auto was_not_taken = [&](const Unread& u) { return !u.sure && (u.at != packet.at || !may_be(u, packet)); };
  while (!unread.empty() && was_not_taken(unread.front())) drop_front(packet.priority);
  if (unread.empty()) return never_took(packet);
  if (!may_be(unread.front(), packet)) {
    if (ledger_.has_taken(packet, node_)) return never_took(packet);
    const Sent* sent = ledger_.find(unread.front().source, unread.front().token);
    complain_(Promise::undamaged,
              (sent ? sent->name() : "a packet") + " came to the CPU of node " + std::to_string(node_) + " changed");
  }
  drop_front(packet.priority);
}

void ReceiveBuffers::never_took(const core::ReceivedPacket& packet) const {
  const bool again = ledger_.has_taken(packet, node_);
  complain_(again ? Promise::exactly_once : Promise::undamaged,
            "node " + std::to_string(node_) + " gave its CPU a packet of node " + std::to_string(packet.source) +
                (again ? " that it had taken before" : " that it was not to take"));
}

void ReceiveBuffers::check_priority(const core::ReceivedPacket& packet, Time now) const {
  const auto waits = [&](const Unread& unread) { return unread.sure && unread.at <= now; };
  for (std::uint8_t higher = 0; higher < packet.priority; ++higher)
    if (std::any_of(unread_[higher].begin(), unread_[higher].end(), waits))
      complain_(Promise::priority_first, "the CPU of node " + std::to_string(node_) + " got a packet of priority " +
                                             std::to_string(packet.priority) + " while one of priority " +
                                             std::to_string(higher) + " waited");
}

void ReceiveBuffers::flush() {
  for (std::uint8_t priority = 0; priority < unread_.size(); ++priority)
    while (!unread_[priority].empty()) drop_front(priority);
}

}  // namespace limb_ring::sim
