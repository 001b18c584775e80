#pragma once

#include <ros/callback_queue_interface.h>

namespace limb_ring::bridge {

/// For subscriptions whose messages are taken at once, in the thread of roscpp's that has read them. In roscpp's own
/// queue a message may be thrown away, where the threads behind it are late, and nobody counts it. (ours)
/// @pre the callbacks wait for nothing: all of this process that comes by TCP is read by that one thread
class DirectQueue : public ros::CallbackQueueInterface {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t) override { callback->call(); }
  void removeByID(std::uint64_t) override {}
};

}  // namespace limb_ring::bridge
