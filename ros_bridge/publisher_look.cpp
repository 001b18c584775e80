#include "ros_bridge/publisher_look.h"

#include "ros_bridge/publisher_counts.h"

namespace limb_ring::bridge {
namespace {

const ros::WallDuration kPublisherLook{1.0};

}  // namespace

PublisherLook::PublisherLook(const ros::NodeHandle& nodes, const std::vector<std::unique_ptr<TopicIn>>& topics)
    : topics_(topics), nodes_(nodes), thread_(1, &queue_) {
  if (topics_.empty()) return;
  nodes_.setCallbackQueue(&queue_);
  timer_ = nodes_.createWallTimer(kPublisherLook, [this](const ros::WallTimerEvent&) { look(); });
  thread_.start();
}

PublisherLook::~PublisherLook() {
  timer_.stop();
  thread_.stop();
}

void PublisherLook::look() {
  const auto counts = publisher_counts();
  for (const auto& topic : topics_) {
    const auto found = counts.find(topic->full_name());
    topic->look(found == counts.end() ? 0 : found->second);
  }
}

}  // namespace limb_ring::bridge
