#include "ros_bridge/publisher_look.h"

#include <algorithm>

#include "ros_bridge/master_state.h"

namespace limb_ring::bridge {
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
