#include "ros_bridge/topic_in.h"

#include <algorithm>

#include "ros_bridge/ros_links.h"

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
          [&port](const Outgoing& packet, RingPort::OnResult done) { port.send(packet, std::move(done)); },
          [this](std::size_t bytes) { warn_too_large(bytes); }, counters),
      nodes_(nodes) {
  port_.every(kAnnouncePeriod, [this] { sender_.announce(); });
  options_.initByFullCallbackType<const Event&>(topic.input, topic.queue,
                                                [this](const Event& event) { on_message(event); });
  options_.callback_queue = &at_once_;
  options_.transport_hints = ros::TransportHints().tcpNoDelay();
  subscriber_ = nodes_.subscribe(options_);
  full_name_ = subscriber_.getTopic();
}

void TopicIn::warn_too_large(std::size_t bytes) {
  const auto held_back = too_large_.allow();
  if (!held_back) return;
  ROS_WARN("topic '%s': a message of %zu bytes was not sent; the largest that crosses the ring has %zu bytes%s",
           topic_.input.c_str(), bytes, TopicSender::kLargest, process::and_more(*held_back).c_str());
}

void TopicIn::look(unsigned published) {
  const unsigned connected = subscriber_.getNumPublishers();
  switch (check_.look(published, connected)) {
    case PublisherCheck::Verdict::well:
      return;
    case PublisherCheck::Verdict::renew:
      return renew();
    case PublisherCheck::Verdict::warn:
      // One that died without telling the master counts as connected.
      ROS_WARN(
          "topic '%s': %u of its %u publishers are not connected: they have another type than the others, or are dead. "
          "'rosnode cleanup' removes dead publishers; a publisher of another type is heard only after that",
          topic_.input.c_str(), published - connected, published);
  }
}

void TopicIn::renew() {
  subscriber_.shutdown();
  subscriber_ = nodes_.subscribe(options_);
}

void TopicIn::take_type(const payload::Announcement& type) {
  if (!md5sum_.empty() && md5sum_ != type.md5sum)
    ROS_WARN(
        "topic '%s' now has the type %s (md5sum %s), before it was %s (md5sum %s). Subscribers of '%s' need the new "
        "type",
        topic_.input.c_str(), type.datatype.c_str(), type.md5sum.c_str(), datatype_.c_str(), md5sum_.c_str(),
        topic_.output.c_str());
  datatype_ = type.datatype;
  md5sum_ = type.md5sum;
}

void TopicIn::on_message(const Event& event) {
  check_.heard();
  auto message = to_message(event);
  take_type(message.type);
  bool first = false;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (handed_in_.size() >= topic_.queue) {
      handed_in_.pop_front();
      counters_.lose("topic_" + topic_.input + "_dropped_queue");
    }
    first = handed_in_.empty();
    handed_in_.push_back(std::move(message));
  }
  // One hand-over takes all messages that wait. If it cannot be posted, the next message tries again.
  if (first && !port_.post([this] { hand_over(); })) {
    std::lock_guard<std::mutex> lock(mutex_);
    counters_.lose("topic_" + topic_.input + "_dropped_busy", handed_in_.size());
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

namespace {

const ros::WallDuration kPublisherLook{1.0};
constexpr unsigned kLookInAnyCase = 10;  // turns of it

}  // namespace

PublisherLook::PublisherLook(const ros::NodeHandle& nodes, const std::vector<std::unique_ptr<TopicIn>>& topics)
    : topics_(topics), nodes_(nodes), thread_(1, &queue_) {
  if (topics_.empty()) return;
  nodes_.setCallbackQueue(&queue_);
  timer_ = nodes_.createSteadyTimer(kPublisherLook, [this](const ros::SteadyTimerEvent&) { look(); });
  thread_.start();
}

PublisherLook::~PublisherLook() {
  timer_.stop();
  thread_.stop();
}

void PublisherLook::look() {
  const bool wanted =
      std::any_of(topics_.begin(), topics_.end(), [](const auto& topic) { return topic->wants_look(); });
  if (!wanted && ++passed_over_ < kLookInAnyCase) return;
  passed_over_ = 0;
  const auto state = master_state();
  if (!state) return;
  for (const auto& topic : topics_)
    topic->look(static_cast<unsigned>(MasterState::of(state->publishers, topic->full_name()).size()));
}

}  // namespace limb_ring::bridge
