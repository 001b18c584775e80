#include "ros_bridge/promises_out.h"

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/console.h>

namespace limb_ring::bridge {
namespace {

using Level = diagnostic_msgs::DiagnosticStatus;

}  // namespace

PromisesOut::PromisesOut(const config::RingConfig& ring, const ConnectOptions& daemon)
    : watch_({ring.ring, ring.node_ids(), ring.folds_back(), daemon.runtime},
             [this](const promises::Breach& breach) {
               const std::string what = std::string(to_string(breach.promise)) + ": " + breach.what;
               if (const auto held_back = told_.allow())
                 ROS_ERROR("promise broken at node %u: %s%s", breach.node, what.c_str(), and_more(*held_back).c_str());
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
