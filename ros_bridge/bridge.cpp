#include "ros_bridge/bridge.h"

#include <rosgraph_msgs/Clock.h>

#include <utility>

namespace limb_ring::bridge {
namespace {

constexpr std::chrono::seconds kAbsence{10}, kAbsenceAgain{60};
constexpr const char* kEndedInOrder = "ringd has ended";  // as ringd says it

// Ten times per alive_period of the bridge.
const ros::WallDuration kAlive{0.1};

/// So that nobody who sends a stop waits for this CPU to say that it has stopped. (docs/reference/requests.md)
constexpr const char* kLatchesNoStop = R"({"do": "stop_latched", "latched": "never"})";

void tell_connected(const ConnectOptions& daemon) {
  if (daemon.role == Role::cpu)
    ROS_INFO("connected to ringd of node '%s' as its CPU", daemon.node.c_str());
  else
    ROS_INFO(
        "connected to ringd of node '%s'. No node of ring %s has 'cpu: attached', so there are status, events "
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
  port_.on_connection([this](const std::string& problem) { tell_connection(problem); });
  port_.on_connection([this](const std::string& problem) {
    if (problem.empty() && parameters_.daemon.role == Role::cpu) port_.request(kLatchesNoStop);
    // As a tool it does not know whether the ring is virtual.
    if (problem.empty() && parameters_.daemon.role == Role::cpu && ros::Time::isSimTime() && !parameters_.follows &&
        !port_.in_lockstep())
      ROS_WARN("/use_sim_time is set, but this ring is live: its stamps follow the machine's clock, not /clock");
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
  alive_ = nodes_.createSteadyTimer(kAlive, [this](const ros::SteadyTimerEvent&) {
    port_.alive();
    warn_of_absence();
  });
}

// Services first: their calls under way still need the ring. Then the ring thread, before what it calls into.
Bridge::~Bridge() {
  follower_.reset();
  services_.reset();
  port_.stop();
}

void Bridge::make_topics() {
  const auto own = parameters_.ring.find(parameters_.daemon.node)->id;
  if (parameters_.daemon.role == Role::cpu && own == config::body_of(parameters_.ring).id)
    sensors_.emplace(nodes_, parameters_.ring, port_, counters_);
  const auto& topics = parameters_.ring.bridge.topics;
  for (std::size_t i = 0; i < topics.size(); ++i)
    if (topics[i].from == own)
      topics_in_.push_back(
          std::make_unique<TopicIn>(nodes_, static_cast<std::uint8_t>(i), topics[i], port_, counters_));
  publishers_.emplace(nodes_, topics_in_);
}

/// A daemon that is not there yet, or that has ended in order, is nothing to be warned of unless it stays away.
void Bridge::tell_connection(const std::string& problem) {
  std::lock_guard<std::mutex> lock(absence_mutex_);
  const bool was_connected = !absent_since_;
  absence_ = problem;
  if (problem.empty()) {
    absent_since_.reset();
    told_waiting_ = true;
    return tell_connected(parameters_.daemon);
  }
  if (was_connected || !told_waiting_) absent_since_ = RingPort::Clock::now();
  const char* node = parameters_.daemon.node.c_str();
  if (!std::exchange(told_waiting_, true)) {
    ROS_INFO("waiting for ringd of node '%s'", node);
    return;
  }
  if (!was_connected) return;
  if (problem.find(kEndedInOrder) != std::string::npos)
    ROS_INFO("node '%s': %s; waiting for the next one", node, problem.c_str());
  else
    ROS_WARN("node '%s': %s (trying again)", node, problem.c_str());
}

void Bridge::warn_of_absence() {
  std::lock_guard<std::mutex> lock(absence_mutex_);
  if (!absent_since_ || RingPort::Clock::now() - *absent_since_ < kAbsence) return;
  absent_since_ = RingPort::Clock::now() + kAbsenceAgain - kAbsence;
  ROS_WARN("node '%s': %s (trying again)", parameters_.daemon.node.c_str(), absence_.c_str());
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
  if (!clock_) clock_ = nodes_.advertise<rosgraph_msgs::Clock>("/clock", 100, /*latch=*/true);  // it may stand for long
  rosgraph_msgs::Clock message;
  message.clock.fromNSec(static_cast<std::uint64_t>(now.count()));
  clock_.publish(message);
}

void Bridge::on_boot(std::uint8_t node) {
  for (auto& topic : topics_in_)
    if (topic->topic().to == node) topic->far_side_restarted();
}

std::optional<std::string> InterruptLog::take(const Interrupt& interrupt, process::Throttle::Clock::time_point now) {
  const bool is_stop = interrupt.action == Interrupt::Action::stop;
  const auto held_back = (is_stop ? stops_ : notifies_).allow(now);
  if (!held_back) return std::nullopt;
  return "INT" + std::to_string(interrupt.factor) + " from node " + ring_.name_of(interrupt.source) +
         (is_stop ? ": stop" : ": notify") + process::and_more(*held_back);
}

}  // namespace limb_ring::bridge
