#include "ros_bridge/topic_in.h"

namespace limb_ring::bridge {
namespace {

constexpr auto kAnnouncePeriod = std::chrono::seconds(1);

TopicMessage to_message(const ros::MessageEvent<topic_tools::ShapeShifter const>& event) {
  const auto& shape = *event.getConstMessage();
  TopicMessage message;
  message.type.datatype = shape.getDataType();
  message.type.md5sum = shape.getMD5Sum();
  message.type.definition = shape.getMessageDefinition();
  const auto& header = event.getConnectionHeader();
  const auto latching = header.find("latching");
  message.type.latching = latching != header.end() && latching->second == "1";
  message.bytes.resize(shape.size());
  ros::serialization::OStream stream(message.bytes.data(), shape.size());
  shape.write(stream);
  return message;
}

}  // namespace

TopicIn::TopicIn(ros::NodeHandle& nodes, std::uint8_t number, const config::TopicConfig& topic, RingPort& port,
                 Counters& counters)
    : topic_(topic),
      port_(port),
      counters_(counters),
      sender_(
          number, topic,
          [&port](const Outgoing& packet, RingPort::OnResult done) { port.send(packet, std::move(done)); }, counters) {
  port_.every(kAnnouncePeriod, [this] { sender_.announce(); });
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const Event&>(topic.input, topic.queue,
                                               [this](const Event& event) { on_message(event); });
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  subscriber_ = nodes.subscribe(options);
}

void TopicIn::on_message(const Event& event) {
  auto message = to_message(event);
  bool first = false;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (handed_in_.size() >= topic_.queue) {
      handed_in_.pop_front();
      counters_.add("topic_" + topic_.input + "_dropped_queue");
    }
    first = handed_in_.empty();
    handed_in_.push_back(std::move(message));
  }
  // One hand-over takes all messages that wait. Where it cannot be posted, the next message tries again.
  if (first && !port_.post([this] { hand_over(); })) {
    std::lock_guard<std::mutex> lock(mutex_);
    counters_.add("topic_" + topic_.input + "_dropped_busy", handed_in_.size());
    handed_in_.clear();
  }
}

void TopicIn::hand_over() {
  std::deque<TopicMessage> messages;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    messages.swap(handed_in_);
  }
  for (auto& message : messages) sender_.offer(std::move(message));
}

void TopicIn::far_side_restarted() {
  port_.post([this] { sender_.far_side_restarted(); });
}

}  // namespace limb_ring::bridge
