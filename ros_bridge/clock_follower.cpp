#include "ros_bridge/clock_follower.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

constexpr auto kFollowConnect = 1s;
constexpr auto kFollowAnswer = 10s;
constexpr auto kFollowRetry = 200ms;
constexpr auto kTellThatItWaits = 5s;                           // of the machine's clock, each time
constexpr double kNsPerSecond = 1e9;                            // ns
constexpr std::int64_t kLongestNs = 1'000'000'000'000'000'000;  // as far as the daemon lets a clock go
constexpr std::int64_t kWorthTellingNs = 1'000'000'000;

double in_seconds(std::int64_t time_ns) { return static_cast<double>(time_ns) / kNsPerSecond; }

/// @throw std::runtime_error if `/clock` is further from the ring's 0 than the ring's clock goes. What it says is
/// the same for each such time, so that it is told once.
void refuse_too_far(std::int64_t time_ns, std::int64_t zero_ns) {
  if (time_ns - zero_ns <= kLongestNs) return;
  std::ostringstream text;
  text << std::fixed << "it has jumped more than " << std::setprecision(0) << in_seconds(kLongestNs) << " s beyond "
       << std::setprecision(6) << in_seconds(zero_ns) << " s, the ring's 0, and a ring's clock goes no further";
  throw std::runtime_error(text.str());
}

/// After a jump back. Time that was allowed before it is still to come, and stamps are counted back from its end.
void tell_how_far_behind(std::int64_t behind_ns) {
  ROS_WARN(
      "the ring is still %.3f s behind the time that /clock had before its jump. Until it has caught up, its stamps "
      "are "
      "that much earlier than /clock, but never below 0",
      in_seconds(behind_ns));
}

}  // namespace

std::optional<OuterTime::Step> OuterTime::next(std::int64_t time_ns) const {
  if (!zero_ns_) return Step{time_ns, time_ns, time_ns, 0, true, false};
  const std::int64_t reached_ns = last_ns_ - *zero_ns_;
  if (time_ns > last_ns_) return Step{last_ns_, time_ns, *zero_ns_, reached_ns, false, false};
  if (time_ns > last_ns_ - kJump) return std::nullopt;
  return Step{last_ns_, time_ns, time_ns - reached_ns, reached_ns, false, true};
}

void OuterTime::allowed(const Step& step) {
  zero_ns_ = step.zero_ns;
  last_ns_ = step.time_ns;
}

void OuterTime::take_over(std::int64_t zero_ns, std::int64_t allowed_ns) {
  if (allowed_ns == 0) return zero_ns_.reset();  // a ring that was started anew meanwhile
  if (zero_ns_) return;
  zero_ns_ = zero_ns;
  last_ns_ = zero_ns + allowed_ns;
}

bool ClockPublisher::is(const std::string& node, Clock::time_point now) {
  if (node != name_ && !name_.empty() && now - heard_ < kSilent) return false;
  name_ = node;
  heard_ = now;
  return true;
}

ClockFollower::ClockFollower(const ros::NodeHandle& nodes, ConnectOptions daemon, RosClock& clock)
    : daemon_(std::move(daemon)), clock_(clock), nodes_(nodes), spinner_(1, &queue_) {
  daemon_.role = Role::tool;
  daemon_.alive_period = 0ms;
  daemon_.timeout = kFollowConnect;
  nodes_.setCallbackQueue(&queue_);
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const Event&>("/clock", 10, [this](const Event& event) { on_clock(event); });
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  subscriber_ = nodes_.subscribe(options);
  spinner_.start();
  thread_ = std::thread([this] { run(); });
}

ClockFollower::~ClockFollower() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
  spinner_.stop();
}

void ClockFollower::on_clock(const Event& event) {
  if (!publisher_.is(event.getPublisherName())) {
    if (others_.allow())
      ROS_WARN("/clock is published by %s and by %s. The ring follows %s until that one stops",
               publisher_.name().c_str(), event.getPublisherName().c_str(), publisher_.name().c_str());
    return;
  }
  std::lock_guard<std::mutex> lock(mutex_);
  newest_ns_ = static_cast<std::int64_t>(event.getMessage()->clock.toNSec());
  wake_.notify_all();
}

std::optional<std::int64_t> ClockFollower::await_time() {
  std::unique_lock<std::mutex> lock(mutex_);
  const auto is_over = [this] { return stopping_ || newest_ns_; };
  // Once it has begun it may stand for long, as a simulation does that is paused.
  while (!outer_.has_begun() && !wake_.wait_for(lock, kTellThatItWaits, is_over))
    ROS_WARN("the ring's time stands at 0 and waits for /clock: %s",
             subscriber_.getNumPublishers() == 0 ? "nobody publishes it; Gazebo does, or rosbag play --clock"
                                                 : "its publisher is silent, and may be paused");
  wake_.wait(lock, is_over);
  return stopping_ ? std::nullopt : std::exchange(newest_ns_, std::nullopt);
}

void ClockFollower::run() {
  std::string told;
  while (!stopping_) {
    try {
      HostPort port = HostPort::connect(daemon_);
      take_over(port);
      while (const auto time_ns = await_time()) pass_on_or_keep(port, *time_ns);
    } catch (const std::exception& problem) {
      if (std::exchange(told, problem.what()) != problem.what())
        ROS_WARN("the ring's clock does not follow /clock: %s (trying again)", problem.what());
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait_for(lock, kFollowRetry, [this] { return stopping_.load(); });
    }
  }
}

void ClockFollower::take_over(HostPort& port) {
  const json state = json::parse(port.ask(R"({"do": "clock"})", kFollowAnswer));
  const std::int64_t allowed_ns = state.value("allowed_ns", std::int64_t{0});
  const bool knew = outer_.has_begun();
  const auto zero_ns = state.value("outer_zero_ns", std::int64_t{0});
  outer_.take_over(zero_ns, allowed_ns);
  if (!knew && outer_.has_begun()) clock_.set_outer_zero(zero_ns);
}

// The clock may stand for long: what is lost then is not made up for by a next time.
void ClockFollower::pass_on_or_keep(HostPort& port, std::int64_t time_ns) {
  try {
    pass_on(port, time_ns);
  } catch (const std::exception&) {
    std::lock_guard<std::mutex> lock(mutex_);
    if (!newest_ns_) newest_ns_ = time_ns;
    throw;
  }
}

// What has not been allowed has not been reached, so it is kept only when the daemon has said yes.
void ClockFollower::pass_on(HostPort& port, std::int64_t time_ns) {
  const auto step = outer_.next(time_ns);
  if (!step) return;
  refuse_too_far(time_ns, step->zero_ns);
  clock_.set_outer_zero(step->zero_ns);
  const json allow{{"do", "allow"}, {"until_ns", step->until_ns()}, {"outer_zero_ns", step->zero_ns}};
  const json state = json::parse(port.ask(allow.dump(), kFollowAnswer));
  if (step->begins) ROS_INFO("the ring's clock follows /clock; its 0 is %.6f s of /clock", in_seconds(time_ns));
  const std::int64_t behind_ns = step->reached_ns - state.value("now_ns", step->reached_ns);
  if (const auto more = step->jumped_back ? jumps_.allow() : std::nullopt)
    ROS_WARN(
        "/clock has jumped back, from %.6f s to %.6f s: the ring goes on from where it is, %.6f s after its start, and "
        "its stamps follow /clock%s",
        in_seconds(step->former_ns), in_seconds(time_ns), in_seconds(step->reached_ns),
        process::and_more(*more).c_str());
  if (step->jumped_back && behind_ns >= kWorthTellingNs && behind_.allow()) tell_how_far_behind(behind_ns);
  outer_.allowed(*step);
}

}  // namespace limb_ring::bridge
