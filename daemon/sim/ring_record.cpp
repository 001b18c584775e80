#include "sim/ring_record.h"

namespace limb_ring::sim {

NodeRecord::NodeRecord(const core::Settings& of_node, Ledger& ledger, const Complain& complain)
    : settings(of_node),
      forwarding(settings.id, settings.byte_time_out, settings.byte_time_in, complain),
      buffers(settings.id, ledger, complain),
      receiver(settings),
      pins(settings.id, complain) {}

RingRecord::RingRecord(VirtualRing& of_ring)
    : ring(of_ring),
      on_complaint([this](Promise promise, std::string what) { complain(promise, std::move(what)); }),
      ledger(ring.size(), ring.settings(ring.order()[0]).fold_back, on_complaint) {
  for (unsigned id = 0; id < ring.size(); ++id)
    nodes.push_back(std::make_unique<NodeRecord>(ring.settings(static_cast<NodeId>(id)), ledger, on_complaint));
  for (const auto& node : nodes) settling = std::max(settling, 4 * node->settings.send_timeout());
}

bool RingRecord::has_news(NodeId node, Time now) const {
  const NodeRecord& n = at(node);
  return n.news_at + told_within(n.settings) >= now;
}

Time RingRecord::last_bit(NodeId node, std::size_t tail_size, Time now) const {
  return now + at(node).settings.byte_time_in * static_cast<std::int64_t>(tail_size);
}

void RingRecord::complain(Promise promise, std::string what) {
  if (!violation) violation = Violation{promise, ring.now(), std::move(what)};
}

}  // namespace limb_ring::sim
