#include "ros_bridge/topic_out.h"

#include <topic_tools/shape_shifter.h>

#include <utility>

#include "limb_ring/payload/packet_type.h"
#include "ros_bridge/ros_links.h"
#include "ros_bridge/topic_sender.h"

namespace limb_ring::bridge {
namespace {

constexpr std::chrono::seconds kToAdvertise{1};
constexpr std::chrono::seconds kUnlinkedWithin{3};  // so long a callback of a subscriber may take

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
  port.every(std::chrono::seconds(1), [this] { each_second(); });
}

void TopicOut::on_packet(const Packet& packet) {
  auto message = reassembler_.take(packet.source, {packet.data.data(), packet.data.size()});
  if (!message) return;
  const auto found = outputs_.find(message->topic);
  if (found == outputs_.end() || found->second.topic.from != message->source) return counters_.lose("topics_unfit");
  if (message->kind == payload::Fragment::Kind::data) return on_message(found->second, std::move(message->bytes));
  on_announced(found->second, *reassembler_.announcement(message->source, message->topic));
}

void TopicOut::on_announced(Output& output, const payload::Announcement& type) {
  if (output.type && is_same_type(*output.type, type) && output.type->latching == type.latching) return;
  if (type.name != output.topic.output)
    ROS_WARN("topic '%s' is announced as '%s': the two bridges read different configurations",
             output.topic.output.c_str(), type.name.c_str());
  output.type = type;
  drop(output, output.waiting.size());
  if (output.is_advertising) return;  // take_advertised() sees that it has become another type
  advertise(output, std::exchange(output.publisher, {}));
  // On a virtual ring no time passes for what is done by another thread.
  if (!port_.in_lockstep()) return;
  const auto is_advertised = [&] {
    take_advertised();
    return static_cast<bool>(output.publisher);
  };
  port_.hold_time_until(is_advertised, kToAdvertise);
}

void TopicOut::advertise(Output& output, ros::Publisher before) {
  output.is_advertising = true;
  advertiser_.post([this, &output, before, type = *output.type]() mutable {
    if (before) {
      before.shutdown();
      await_unlinked(nodes_.resolveName(output.topic.output), kUnlinkedWithin);
    }
    ros::Publisher publisher = shape_of(type).advertise(nodes_, output.topic.output, output.topic.queue, type.latching);
    {
      std::lock_guard<std::mutex> lock(mutex_);
      advertised_.push_back({&output, publisher, type});
    }
    port_.post([this] { take_advertised(); });  // where too much waits already, the next message or second does it
  });
}

void TopicOut::take_advertised() {
  std::vector<Advertised> all;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    all.swap(advertised_);
  }
  for (Advertised& one : all) {
    Output& output = *one.output;
    output.is_advertising = false;
    if (!(one.type == *output.type)) {
      advertise(output, one.publisher);
      continue;
    }
    output.publisher = one.publisher;
    for (; !output.waiting.empty(); output.waiting.pop_front()) publish(output, std::move(output.waiting.front()));
  }
}

void TopicOut::on_message(Output& output, std::vector<std::uint8_t> bytes) {
  if (!output.type) return counters_.lose("topics_unfit");
  take_advertised();
  if (output.publisher) return publish(output, std::move(bytes));
  output.waiting.push_back(std::move(bytes));
  if (output.waiting.size() > output.topic.queue) drop(output, 1);
}

void TopicOut::drop(Output& output, std::size_t oldest) {
  if (oldest == 0) return;
  output.waiting.erase(output.waiting.begin(), output.waiting.begin() + static_cast<std::ptrdiff_t>(oldest));
  counters_.lose("topic_" + output.topic.output + "_dropped_queue", oldest);
}

void TopicOut::publish(Output& output, std::vector<std::uint8_t> bytes) {
  auto shape = shape_of(*output.type);
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  shape.read(stream);
  port_.tell_time();
  output.publisher.publish(shape);
  counters_.add("topic_" + output.topic.output + "_received");
}

void TopicOut::each_second() {
  if (outputs_.empty()) return;
  take_advertised();
  const auto& c = reassembler_.counters();
  counters_.set_lost("topics_lost_a_fragment", c.lost);
  counters_.set_lost("topics_unannounced", c.unannounced);
  counters_.set_lost("topics_too_large", c.too_large);
  counters_.set_lost("topics_no_memory", c.no_memory + c.evicted);
  counters_.set_lost("topics_corrupt", c.corrupt + c.malformed);
}

}  // namespace limb_ring::bridge
