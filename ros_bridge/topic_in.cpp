#include "ros_bridge/topic_in.h"

#include <ros/master.h>

#include <algorithm>
#include <utility>

namespace limb_ring::bridge {
namespace {

constexpr auto kAnnouncePeriod = std::chrono::seconds(1);
const ros::WallDuration kPublisherLook{1.0};

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

bool is_published(const std::string& name) {
  ros::master::V_TopicInfo topics;
  return ros::master::getTopics(topics) &&
         std::any_of(topics.begin(), topics.end(), [&](const auto& topic) { return topic.name == name; });
}

}  // namespace

TopicIn::TopicIn(ros::NodeHandle& nodes, std::uint8_t number, const config::TopicConfig& topic, RingPort& port,
                 Counters& counters)
    : topic_(topic),
      port_(port),
      counters_(counters),
      sender_(
          number, topic,
          [&port](const Outgoing& packet, RingPort::OnResult done) { port.send(packet, std::move(done)); }, counters),
      nodes_(nodes) {
  port_.every(kAnnouncePeriod, [this] { sender_.announce(); });
  options_.initByFullCallbackType<const Event&>(topic.input, topic.queue,
                                                [this](const Event& event) { on_message(event); });
  options_.transport_hints = ros::TransportHints().tcpNoDelay();
  subscriber_ = nodes_.subscribe(options_);
  look_ = nodes_.createWallTimer(kPublisherLook, [this](const ros::WallTimerEvent&) { renew_where_refused(); });
}

// roscpp takes type and definition of the first publisher for those of the subscription, and publishers with others
// refuse it. The master does not know definitions, so where one is there and not connected for two looks, the
// subscription is made anew. The master is asked only where nobody is connected, and not waited for: this thread is the
// CPU's.
void TopicIn::renew_where_refused() {
  const bool refused = subscriber_.getNumPublishers() == 0 && is_published(subscriber_.getTopic());
  refused_ = refused ? refused_ + 1 : 0;
  if (refused_ < 2) return;
  refused_ = 0;
  subscriber_.shutdown();
  subscriber_ = nodes_.subscribe(options_);
}

void TopicIn::take_type(const payload::Announcement& type) {
  if (!md5sum_.empty() && md5sum_ != type.md5sum)
    ROS_WARN("topic '%s' is %s (md5sum %s) from here on, it was %s (md5sum %s): who hears '%s' has to take that type",
             topic_.input.c_str(), type.datatype.c_str(), type.md5sum.c_str(), datatype_.c_str(), md5sum_.c_str(),
             topic_.output.c_str());
  datatype_ = type.datatype;
  md5sum_ = type.md5sum;
}

void TopicIn::on_message(const Event& event) {
  auto message = to_message(event);
  take_type(message.type);
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
