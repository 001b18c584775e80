#include "study/baselines/responsive_link.h"

#include "study/baselines/point_to_point.h"

namespace limb_ring::study {

std::vector<Time> ResponsiveLink::carry(const Medium& medium, const std::vector<Message>& messages, Time until) const {
  Deliveries deliveries(messages.size(), until);
  PointToPoint(medium, messages, kDataPacket, kPacketData, deliveries).carry(false);
  PointToPoint(medium, messages, kEventPacket, kEventPacket, deliveries).carry(true);
  return deliveries.result();
}

Duration ResponsiveLink::time_to_join(const Medium&) const { return Duration{0}; }

}  // namespace limb_ring::study
