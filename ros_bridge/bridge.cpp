#include "ros_bridge/bridge.h"

#include <rosgraph_msgs/Clock.h>

#include <utility>

namespace limb_ring::bridge {
namespace {

// Ten times per alive_period of the bridge.
const ros::WallDuration kAlive{0.1};

/// So that nobody who sends a stop waits for this CPU to say that it has stopped. (docs/reference/requests.md)
constexpr const char* kLatchesNoStop = R"({"do": "stop_latched", "latched": "never"})";

void tell_connection(const ConnectOptions& daemon, const std::string& problem) {
  if (!problem.empty())
    ROS_WARN("node '%s': %s (trying again)", daemon.node.c_str(), problem.c_str());
  else if (daemon.role == Role::cpu)
    ROS_INFO("connected to ringd of node '%s' as its CPU", daemon.node.c_str());
  else
    ROS_WARN(
        "connected to ringd of node '%s', but no node of ring %s has 'cpu: attached': there are status, events "
        "and services, but no joint data and no topics",
        daemon.node.c_str(), daemon.ring.c_str());
}

FrameFilter frame_filter(const Parameters& parameters) {
  return read_frame_filter(parameters.frames, parameters.ring, *parameters.ring.find(parameters.daemon.node));
}

}  // namespace

Bridge::Bridge(ros::NodeHandle nodes, Parameters parameters)
    : nodes_(std::move(nodes)),
      parameters_(std::move(parameters)),
      port_(parameters_.daemon),
      joints_(nodes_, parameters_.ring, parameters_.rate, port_, counters_, parameters_.sample_log),
      topics_out_(nodes_, parameters_.ring, parameters_.ring.find(parameters_.daemon.node)->id, port_, counters_),
      commands_(
          nodes_, parameters_.ring, port_, [this](std::uint8_t node) { return joints_.speaks(node); }, counters_),
      controllers_(parameters_.ring, port_, joints_, commands_),
      diagnostics_(nodes_, parameters_.ring, counters_, port_.ros_clock()),
      events_(nodes_, parameters_.ring, parameters_.daemon, counters_, port_.ros_clock()),
      status_(nodes_, parameters_.ring, parameters_.daemon, port_, joints_, events_, counters_,
              [this](std::uint8_t node) { on_boot(node); }),
      frames_(nodes_, parameters_.ring, parameters_.daemon, frame_filter(parameters_), counters_, port_.ros_clock()),
      interrupts_(parameters_.ring),
      services_(std::make_unique<Services>(nodes_, parameters_.ring, parameters_.daemon, port_, commands_)) {
  make_topics();
  port_.on_connection([daemon = parameters_.daemon](const auto& problem) { tell_connection(daemon, problem); });
  port_.on_connection([this](const std::string& problem) {
    if (problem.empty() && parameters_.daemon.role == Role::cpu) port_.request(kLatchesNoStop);
    if (problem.empty() && ros::Time::isSimTime() && !parameters_.follows && !port_.in_lockstep())
      ROS_WARN(
          "/use_sim_time is set, but this ring is live: it and its stamps go by the machine's clock, not by /clock");
  });
  port_.on_interrupt([this](const Interrupt& interrupt) { tell_interrupt(interrupt); });
  if (parameters_.tells_time) port_.on_time([this](std::chrono::nanoseconds now) { tell_time(now); });
  if (parameters_.follows) follower_.emplace(nodes_, parameters_.daemon, port_.ros_clock());
  if (parameters_.promises) {
    promises_.emplace(parameters_.ring, parameters_.daemon);
    diagnostics_.add(*promises_);
  }
  status_.on_status([this](const RingStatus& status) { diagnostics_.take(status); });
  port_.start();
  status_.start();
  // Called by the thread that serves ROS, because the sign of life is about this thread.
  alive_ = nodes_.createWallTimer(kAlive, [this](const ros::WallTimerEvent&) { port_.alive(); });
}

// Services first: their calls under way still need the ring. Then the ring thread, before what it calls into.
Bridge::~Bridge() {
  follower_.reset();
  services_.reset();
  port_.stop();
}

void Bridge::make_topics() {
  const auto own = parameters_.ring.find(parameters_.daemon.node)->id;
  const auto& topics = parameters_.ring.bridge.topics;
  for (std::size_t i = 0; i < topics.size(); ++i)
    if (topics[i].from == own)
      topics_in_.push_back(
          std::make_unique<TopicIn>(nodes_, static_cast<std::uint8_t>(i), topics[i], port_, counters_));
  publishers_.emplace(nodes_, topics_in_);
}

void Bridge::tell_interrupt(const Interrupt& interrupt) {
  counters_.add("interrupts_in");
  const auto line = interrupts_.take(interrupt);
  if (!line) return;
  if (interrupt.action == Interrupt::Action::stop)
    ROS_WARN("%s", line->c_str());
  else
    ROS_INFO("%s", line->c_str());
}

void Bridge::tell_time(std::chrono::nanoseconds now) {
  if (!clock_) clock_ = nodes_.advertise<rosgraph_msgs::Clock>("/clock", 100);
  rosgraph_msgs::Clock message;
  message.clock.fromNSec(static_cast<std::uint64_t>(now.count()));
  clock_.publish(message);
}

void Bridge::on_boot(std::uint8_t node) {
  for (auto& topic : topics_in_)
    if (topic->topic().to == node) topic->far_side_restarted();
}

}  // namespace limb_ring::bridge
