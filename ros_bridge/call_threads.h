#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "ros_bridge/two_names.h"

namespace limb_ring::bridge {

/// Services that are called by threads of their own. (ours)
class CallThreads {
 public:
  /// @param nodes of their short names
  /// @param threads so many calls are served at a time, the others wait
  CallThreads(const ros::NodeHandle& nodes, unsigned threads)
      : nodes_(nodes), threads_(threads, &queue_), names_(on_own_queue()) {}

  /// Where services are advertised. @pre not yet started
  TwoNames& names() { return names_; }
  void start() { threads_.start(); }
  /// Returns when the calls under way have ended; there are no further ones.
  void stop() {
    names_.shutdown();
    threads_.stop();
  }

 private:
  const ros::NodeHandle& on_own_queue() {
    nodes_.setCallbackQueue(&queue_);
    return nodes_;
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle nodes_;
  ros::AsyncSpinner threads_;
  TwoNames names_;
};

}  // namespace limb_ring::bridge
