#include "ros_bridge/diagnostics_out.h"

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/console.h>

#include <algorithm>
#include <utility>

#include "ros_bridge/health.h"

namespace limb_ring::bridge {
namespace {

using diagnostic_updater::DiagnosticStatusWrapper;
using Clock = std::chrono::steady_clock;

std::string prefix_in(const ros::NodeHandle& nodes) { return nodes.resolveName("limb_ring").substr(1); }

}  // namespace

DiagnosticsOut::DiagnosticsOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const Counters& counters,
                               const RosClock& clock)
    : counters_(counters), updater_(nodes, prefix_in(nodes), ring.ring, clock) {
  updater_.add("ring", [this](DiagnosticStatusWrapper& out) { tell_bridge(out); });
  for (std::size_t i = 0; i < ring.nodes.size(); ++i) {
    NodeHealth& node = nodes_.emplace_back(ring.nodes[i], ring.timeouts.beacon);
    updater_.add(ring.nodes[i].name, [&node](DiagnosticStatusWrapper& out) { node.tell(out, Clock::now()); });
    LineHealth& line = lines_.emplace_back(ring.nodes[i], ring.nodes[(i + 1) % ring.nodes.size()]);
    updater_.add(line.name(), [&line](DiagnosticStatusWrapper& out) { line.tell(out, Clock::now()); });
  }
}

void DiagnosticsOut::add(const PromisesOut& promises) {
  updater_.add("promises", [&promises](DiagnosticStatusWrapper& out) { promises.tell(out); });
}

void DiagnosticsOut::take(const RingStatus& status) {
  status_ = status;
  losses_.take(counters_.losses(), Clock::now());
  for (NodeHealth& node : nodes_) node.take(status, Clock::now());
  for (LineHealth& line : lines_) line.take(status, Clock::now());
  updater_.update();
}

void DiagnosticsOut::tell_bridge(DiagnosticStatusWrapper& out) {
  tell_ring(status_, out);
  losses_.tell(out, Clock::now());
  out.add("ring", status_.ring);
  out.add("bridge at node", status_.node);
  out.add("ring size", status_.ring_size);
  for (std::size_t i = 0; i < status_.counter_names.size(); ++i)
    out.add(status_.counter_names[i], status_.counter_values[i]);
}

BridgeLosses::BridgeLosses() : recent_(kWarnFor) {}

// They begin at 0 together with this: the first report may tell of losses already.
void BridgeLosses::take(const Counters::Values& losses, Clock::time_point now) {
  for (const auto& [name, value] : losses) {
    const std::uint64_t before = std::exchange(last_[name], value);
    if (value > before) recent_.note(name, name + " +" + std::to_string(value - before), now);
  }
}

void BridgeLosses::tell(diagnostic_updater::DiagnosticStatusWrapper& out, Clock::time_point now) {
  std::string lost;
  recent_.each(now, [&](const std::string& text) { lost += (lost.empty() ? "" : ", ") + text; });
  if (lost.empty()) return;
  constexpr int kWarn = diagnostic_msgs::DiagnosticStatus::WARN;
  out.summary(static_cast<unsigned char>(std::max<int>(out.level, kWarn)),
              out.message + "; lately lost by the bridge: " + lost);
}

namespace {

using Level = diagnostic_msgs::DiagnosticStatus;

}  // namespace

PromisesOut::PromisesOut(const config::RingConfig& ring, const ConnectOptions& daemon)
    : watch_({ring.ring, ring.node_ids(), ring.folds_back(), daemon.runtime},
             [this](const promises::Breach& breach) {
               const std::string what = std::string(to_string(breach.promise)) + ": " + breach.what;
               if (const auto held_back = told_.allow())
                 ROS_ERROR("promise broken at node %u: %s%s", breach.node, what.c_str(),
                           process::and_more(*held_back).c_str());
               std::lock_guard<std::mutex> lock(mutex_);
               last_ = what;
             }),
      thread_([this] { run(); }) {}

PromisesOut::~PromisesOut() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void PromisesOut::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopping_) {
    lock.unlock();
    std::string problem;
    try {
      watch_.poll();
    } catch (const std::exception& error) {
      problem = error.what();
    }
    lock.lock();
    problem_ = problem;
    counts_ = watch_.counts();
    watched_ = watch_.watched();
    wake_.wait_for(lock, live::PromiseWatch::kRound, [this] { return stopping_; });
  }
}

void PromisesOut::tell(diagnostic_updater::DiagnosticStatusWrapper& out) const {
  std::lock_guard<std::mutex> lock(mutex_);
  if (counts_.breaches != 0)
    out.summary(Level::ERROR, std::to_string(counts_.breaches) + " broken; last: " + last_);
  else if (!problem_.empty() || watched_ == 0)
    out.summary(Level::WARN, problem_.empty() ? "no node is there to be watched" : problem_);
  else
    out.summary(Level::OK, "every promise was kept");
  out.add("nodes watched", watched_);
  out.add("sends", counts_.sends);
  out.add("packets and pins", counts_.packets);
  out.add("broken", counts_.breaches);
  out.add("not judged", counts_.all_unjudged());
  out.add("observations lost", counts_.lost);
  out.add("last broken", last_.empty() ? "none" : last_);
}

}  // namespace limb_ring::bridge
