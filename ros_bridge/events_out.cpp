#include "ros_bridge/events_out.h"

namespace limb_ring::bridge {
namespace {

constexpr std::uint32_t kEventsQueue = 1000;  // a restart of the ring is some ten events of every node
constexpr const char* kOrder = R"({"kinds": ["state", "link", "pin", "cpu"]})";

}  // namespace

EventsOut::EventsOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const ConnectOptions& daemon,
                     Counters& counters, const RosClock& clock)
    : counters_(counters),
      clock_(clock),
      conversion_(ring),
      publisher_(nodes.advertise<RingEvent>("ring_events", kEventsQueue)),
      listener_(
          all_nodes(ring), daemon, kOrder,
          [this](const config::NodeConfig& node, const Message& message) { take(node, message); },
          [this](const config::NodeConfig& node) { return conversion_.is_open(node); }) {}

void EventsOut::take(const config::NodeConfig& node, const Message& message) {
  if (const auto* seen = std::get_if<Observed>(&message)) {
    for (RingEvent& event : conversion_.events_of(node, seen->json)) {
      event.header.stamp = clock_.to_ros(static_cast<std::int64_t>(event.header.stamp.toNSec()));
      publisher_.publish(event);
    }
  } else if (const auto* lost = std::get_if<ObservedLost>(&message)) {
    counters_.lose("events_lost", lost->count);
  } else if (std::holds_alternative<Disconnected>(message)) {
    publish_now(conversion_.gone(node));
  } else if (const auto* reply = std::get_if<Reply>(&message)) {
    for (const RingEvent& event : conversion_.events_of_row(node, reply->json)) publish_now(event);
  }
}

void EventsOut::publish_now(RingEvent event) {
  event.header.stamp = clock_.now();
  publisher_.publish(event);
}

}  // namespace limb_ring::bridge
