#include "ros_bridge/status_out.h"

#include <std_msgs/Bool.h>

#include <algorithm>

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPollPeriod = 100ms;  // between polls for a change
constexpr auto kPeriod = 1s;

}  // namespace

StatusOut::StatusOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const ConnectOptions& daemon,
                     RingPort& port, const JointDataOut& joints, const EventsOut& events, const Counters& counters,
                     OnBoot on_boot)
    : ring_(ring),
      own_node_(daemon.node),
      clock_(port.ros_clock()),
      watch_(ring, daemon),
      joints_(joints),
      events_(events),
      counters_(counters),
      on_boot_(std::move(on_boot)),
      publisher_(nodes.advertise<RingStatus>("ring_status", 1, /*latch=*/true)),
      stopped_(nodes.advertise<std_msgs::Bool>("stopped", 1, /*latch=*/true)) {
  port.on_connection([this](const std::string& problem) {
    std::lock_guard<std::mutex> lock(mutex_);
    problem_ = problem;
    wake_.notify_all();
  });
}

StatusOut::~StatusOut() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void StatusOut::start() {
  thread_ = std::thread([this] { run(); });
}

void StatusOut::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopping_) {
    lock.unlock();
    if (is_due()) publish();
    lock.lock();
    if (!stopping_) wake_.wait_for(lock, kPollPeriod);
  }
}

std::string StatusOut::problem() {
  std::lock_guard<std::mutex> lock(mutex_);
  return problem_;
}

bool StatusOut::is_due() {
  auto digest = watch_.digest();
  auto silent = joints_.silent_joints();
  auto now_wrong = problem();
  auto stops_now = stops();
  const bool changed =
      digest != last_digest_ || silent != last_silent_ || now_wrong != last_problem_ || stops_now != last_stops_;
  last_digest_ = std::move(digest);
  last_silent_ = std::move(silent);
  last_problem_ = std::move(now_wrong);
  last_stops_ = std::move(stops_now);
  return changed || Clock::now() - last_time_ >= kPeriod;
}

void StatusOut::publish() {
  last_time_ = Clock::now();
  RingStatus status;
  fill_header(status);
  status.nodes = watch_.poll();
  for (auto& node : status.nodes) {
    fill_joints(node);
    node.events_heard = events_.hears(node.id);
  }
  const auto own = std::find_if(status.nodes.begin(), status.nodes.end(),
                                [this](const auto& node) { return node.name == own_node_; });
  if (own != status.nodes.end()) status.ring_size = own->ring_size;
  status.stopped = std::any_of(status.nodes.begin(), status.nodes.end(), [](const auto& node) { return node.stopped; });
  for (const auto node : watch_.take_restarted()) on_boot_(node);
  publisher_.publish(status);
  tell_stopped(status);
  for (const auto& handler : on_status_) handler(status);
}

void StatusOut::fill_header(RingStatus& status) {
  status.header.stamp = clock_.now();
  status.ring = ring_.ring;
  status.node = own_node_;
  status.message = last_problem_;
  status.connected = last_problem_.empty();
  status.silent_joints = last_silent_;
  for (const auto& [name, value] : counters_.all()) {
    status.counter_names.push_back(name);
    status.counter_values.push_back(value);
  }
}

void StatusOut::fill_joints(NodeStatus& node) const {
  const auto received = joints_.received(node.id);
  node.states_received = received.states;
  node.states_missing = received.missing;
  node.commands_not_obeyed = received.refused;
  node.stopped |= received.stopped;  // they come sooner than what is asked for
}

std::string StatusOut::stops() const {
  std::string stops;
  for (const auto& node : ring_.nodes)
    if (joints_.received(node.id).stopped) stops += node.name + ' ';
  return stops;
}

void StatusOut::tell_stopped(const RingStatus& status) {
  if (last_stopped_ == bool(status.stopped)) return;
  last_stopped_ = status.stopped;
  std_msgs::Bool message;
  message.data = status.stopped;
  stopped_.publish(message);
}

}  // namespace limb_ring::bridge
