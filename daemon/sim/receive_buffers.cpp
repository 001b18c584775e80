#include "sim/receive_buffers.h"

namespace limb_ring::sim {

void ReceiveBuffers::put(const Sent* sent, NodeId source, std::uint8_t priority, Time at) {
  unread_[priority].push_back({source, sent ? sent->token : 0, at});
  if (sent) ++ledger_.find(source, sent->token)->unread;
}

void ReceiveBuffers::read(const core::ReceivedPacket& packet, Time now) {
  check_priority(packet, now);
  auto& unread = unread_[packet.priority];
  if (unread.empty())
    return complain_(Promise::undamaged, "node " + std::to_string(node_) + " gave its CPU a packet it never took");
  const Unread first = unread.front();
  unread.pop_front();
  Sent* sent = ledger_.find(first.source, first.token);
  if (!sent) return;
  --sent->unread;
  if (!sent->is(packet))
    complain_(Promise::undamaged, sent->name() + " came to the CPU of node " + std::to_string(node_) + " changed");
}

void ReceiveBuffers::check_priority(const core::ReceivedPacket& packet, Time now) const {
  for (std::uint8_t higher = 0; higher < packet.priority; ++higher)
    if (!unread_[higher].empty() && unread_[higher].front().at <= now)
      complain_(Promise::priority_first, "the CPU of node " + std::to_string(node_) + " got a packet of priority " +
                                             std::to_string(packet.priority) + " while one of priority " +
                                             std::to_string(higher) + " waited");
}

void ReceiveBuffers::flush() {
  for (auto& unread : unread_) {
    for (const Unread& packet : unread)
      if (Sent* sent = ledger_.find(packet.source, packet.token)) --sent->unread;
    unread.clear();
  }
}

}  // namespace limb_ring::sim
