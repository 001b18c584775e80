#include "ros_bridge/topic_out.h"

#include <topic_tools/shape_shifter.h>

#include "limb_ring/payload/packet_type.h"
#include "ros_bridge/topic_sender.h"

namespace limb_ring::bridge {
namespace {

topic_tools::ShapeShifter shape_of(const payload::Announcement& type) {
  topic_tools::ShapeShifter shape;
  shape.morph(type.md5sum, type.datatype, type.definition, type.latching ? "1" : "0");
  return shape;
}

}  // namespace

TopicOut::TopicOut(ros::NodeHandle& nodes, const config::RingConfig& ring, std::uint8_t own_id, RingPort& port,
                   Counters& counters)
    : nodes_(nodes), port_(port), counters_(counters) {
  for (std::size_t i = 0; i < ring.bridge.topics.size(); ++i)
    if (ring.bridge.topics[i].to == own_id) outputs_[static_cast<std::uint8_t>(i)].topic = ring.bridge.topics[i];
  port.on_packet(payload::kTopicChannel, [this](const Packet& packet) { on_packet(packet); });
  port.every(std::chrono::seconds(1), [this] { show_counters(); });
}

void TopicOut::on_packet(const Packet& packet) {
  auto message = reassembler_.take(packet.source, {packet.data.data(), packet.data.size()});
  if (!message) return;
  const auto found = outputs_.find(message->topic);
  if (found == outputs_.end() || found->second.topic.from != message->source) return counters_.add("topics_unfit");
  if (message->kind == payload::Fragment::Kind::data) return on_message(found->second, std::move(message->bytes));
  on_announced(found->second, *reassembler_.announcement(message->source, message->topic));
}

void TopicOut::on_announced(Output& output, const payload::Announcement& type) {
  if (output.publisher && is_same_type(output.type, type) && output.type.latching == type.latching) return;
  if (type.name != output.topic.output)
    ROS_WARN("topic '%s' is announced as '%s': the two bridges read different configurations",
             output.topic.output.c_str(), type.name.c_str());
  if (output.publisher) output.publisher.shutdown();
  output.type = type;
  output.publisher = shape_of(type).advertise(nodes_, output.topic.output, output.topic.queue, type.latching);
}

void TopicOut::on_message(Output& output, std::vector<std::uint8_t> bytes) {
  if (!output.publisher) return counters_.add("topics_unfit");
  auto shape = shape_of(output.type);
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  shape.read(stream);
  port_.tell_time();
  output.publisher.publish(shape);
  counters_.add("topic_" + output.topic.output + "_received");
}

void TopicOut::show_counters() {
  if (outputs_.empty()) return;
  const auto& c = reassembler_.counters();
  counters_.set("topics_lost_a_fragment", c.lost);
  counters_.set("topics_unannounced", c.unannounced);
  counters_.set("topics_too_large", c.too_large);
  counters_.set("topics_no_memory", c.no_memory + c.evicted);
  counters_.set("topics_corrupt", c.corrupt + c.malformed);
}

}  // namespace limb_ring::bridge
