#include "ros_bridge/frames_out.h"

#include "ros_bridge/frame_conversion.h"

namespace limb_ring::bridge {
namespace {

constexpr std::uint32_t kFramesQueue = 1000;  // a second of them, by default

}  // namespace

FramesOut::FramesOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const ConnectOptions& daemon,
                     FrameFilter filter, Counters& counters, const RosClock& clock)
    : ring_(ring),
      daemon_(daemon),
      filter_(std::move(filter)),
      counters_(counters),
      clock_(clock),
      nodes_(nodes),
      thread_(1, &queue_) {
  nodes_.setCallbackQueue(&queue_);
  const auto changed = [this](const ros::SingleSubscriberPublisher&) { on_subscribers(); };
  publisher_ = nodes_.advertise<Frame>("ring_frames", kFramesQueue, changed, changed);
  counters_.set("frames_watched_nodes", 0);
  thread_.start();
}

FramesOut::~FramesOut() { thread_.stop(); }

void FramesOut::on_subscribers() {
  const bool wanted = publisher_.getNumSubscribers() > 0;
  if (wanted == (listener_ != nullptr)) return;
  listener_.reset();
  counts_.clear();
  if (wanted)
    listener_ = std::make_unique<RingListener>(
        filter_.nodes, daemon_, filter_.order,
        [this](const config::NodeConfig& node, const Message& message) { take(node, message); });
  counters_.set("frames_watched_nodes", wanted ? filter_.nodes.size() : 0);
}

void FramesOut::take(const config::NodeConfig& node, const Message& message) {
  if (const auto* packet = std::get_if<CapturedPacket>(&message)) {
    publish(node, *packet);
  } else if (const auto* counts = std::get_if<CaptureCounts>(&message)) {
    counts_[node.id] = *counts;
  } else if (const auto* seen = std::get_if<Observed>(&message)) {
    ROS_WARN("node '%s' does not show its frames: %s", node.name.c_str(), seen->json.c_str());
  }
}

void FramesOut::publish(const config::NodeConfig& node, const CapturedPacket& packet) {
  CaptureCounts& counts = counts_[node.id];
  counts.lost += packet.lost_before;
  Frame frame = to_frame(packet, node, ring_);
  frame.header.stamp = clock_.to_ros(packet.time_ns);
  frame.filtered = counts.filtered;
  frame.sampled_out = counts.sampled_out;
  frame.limited = counts.limited;
  frame.lost = counts.lost;
  publisher_.publish(frame);
}

}  // namespace limb_ring::bridge
