#include "ros_bridge/status_out.h"

#include <ros/console.h>
#include <std_msgs/Bool.h>

#include <algorithm>
#include <utility>

#include "ros_bridge/conversions.h"
#include "ros_bridge/health.h"
#include "wire/control_message.h"

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
  Noticed now{watch_.digest(), joints_.silent_joints(), joints_.silent_sensors(), problem(), stopped_nodes()};
  const bool changed = now != noticed_;
  noticed_ = std::move(now);
  return changed || Clock::now() - published_ >= kPeriod;
}

void StatusOut::publish() {
  published_ = Clock::now();
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
  if (status.connected) status.message = what_is_wrong(status.nodes);
  for (const auto node : watch_.take_restarted()) on_boot_(node);
  publisher_.publish(status);
  tell_stopped(status);
  for (const auto& handler : on_status_) handler(status);
}

void StatusOut::fill_header(RingStatus& status) {
  status.header.stamp = clock_.now();
  status.ring = ring_.ring;
  status.node = own_node_;
  status.message = noticed_.problem;
  status.connected = noticed_.problem.empty();
  status.silent_joints = noticed_.silent;
  status.silent_sensors = noticed_.silent_sensors;
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
  // What the bridge sees itself is newer; what the node's daemon has found is there already.
  if (const std::string problem = joints_.problem_of(node.id); !problem.empty()) node.problem = problem;
  node.stopped |= received.stopped;  // they come sooner than what is asked for
}

std::vector<std::string> StatusOut::stopped_nodes() const {
  std::vector<std::string> names;
  for (const auto& node : ring_.nodes)
    if (joints_.received(node.id).stopped) names.push_back(node.name);
  return names;
}

void StatusOut::tell_stopped(const RingStatus& status) {
  if (told_stopped_ == bool(status.stopped)) return;
  told_stopped_ = status.stopped;
  std_msgs::Bool message;
  message.data = status.stopped;
  stopped_.publish(message);
}

namespace {

constexpr auto kStatusAnswer = 500ms;
constexpr auto kStatusRetry = 1s;  // a node that is not there, or on another host, is not asked in vain all the time

std::vector<ask::Node> nodes_of(const config::RingConfig& ring) {
  std::vector<ask::Node> nodes;
  for (const config::NodeConfig& node : ring.nodes) nodes.push_back({node.id, node.name});
  return nodes;
}

ask::RingClient::Deadline soon() { return std::chrono::steady_clock::now() + kStatusAnswer; }

}  // namespace

RingWatch::RingWatch(const config::RingConfig& ring, const ConnectOptions& daemon)
    : ring_(ring),
      client_(daemon.ring, nodes_of(ring), live::Stay::for_long, daemon.runtime),
      own_(static_cast<std::size_t>(ring.find(daemon.node) - ring.nodes.data())),
      told_(ring.nodes.size()) {
  client_.pause = kStatusRetry;
}

void RingWatch::tell(std::size_t node, const ask::ToldRow& row) {
  const std::string wrong = row.unreadable ? row.why_not : "";
  if (std::exchange(told_[node], wrong) != wrong && row.unreadable)
    ROS_WARN("the status of node '%s' cannot be read, and its daemon counts as silent: %s",
             ring_.nodes[node].name.c_str(), wrong.c_str());
}

std::string RingWatch::digest() {
  const ask::ToldRow own = client_.status_of(own_, soon());
  tell(own_, own);
  if (!own.said) return "";
  const status::NodeRow& row = *own.said;
  std::string digest = row.state + ' ' + std::to_string(row.ring_size.value_or(0)) + ' ' + row.cpu.state + ' ' +
                       std::to_string(row.cpu.boots.value_or(0));
  for (const status::Heard& heard : row.heard)
    digest += '\n' + std::to_string(heard.id) + ' ' + std::to_string(heard.boot) + ' ' +
              std::to_string(heard.beacon.cpu_boots) + ' ' + heard.cpu_state() +
              (heard.beacon.stop_latched ? " stopped" : "");
  return digest;
}

void RingWatch::notice_boots(const status::NodeRow& own) {
  for (const status::Heard& heard : own.heard)
    if (boots_.take(heard.id, heard.boot, heard.beacon.cpu_boots)) restarted_.push_back(heard.id);
}

std::vector<NodeStatus> RingWatch::poll() {
  const std::vector<ask::ToldRow> told = client_.status(soon());
  const auto& own = told[own_].said;
  if (own) notice_boots(*own);
  const auto fresh = wire::kMissedBeacons * ring_.timeouts.beacon;
  std::vector<NodeStatus> all;
  for (std::size_t i = 0; i < told.size(); ++i) {
    NodeStatus status = unheard_node(ring_.nodes[i]);
    tell(i, told[i]);
    if (told[i].said) merge_status_row(*told[i].said, status);
    if (own)
      for (const status::Heard& heard : own->heard)
        if (heard.id == status.id) merge_beacon(heard, fresh, status);
    all.push_back(std::move(status));
  }
  return all;
}

}  // namespace limb_ring::bridge
