#pragma once

#include <ros/callback_queue.h>
#include <ros/callback_queue_interface.h>
#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "io/throttle.h"
#include "ros_bridge/topic_sender.h"

namespace limb_ring::bridge {

/// For subscriptions whose callbacks run at once, in the roscpp thread that has read the message. If the threads behind
/// roscpp's own queue are late, it drops messages, and nobody counts them. (ours)
/// @pre the callbacks never wait: that one thread reads everything that comes to this process by TCP
class DirectQueue : public ros::CallbackQueueInterface {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t) override { callback->call(); }
  void removeByID(std::uint64_t) override {}
};

/// Whether all publishers of a topic of any type are connected to its subscription. (ours)
///
/// roscpp takes the type and definition of the first publisher as those of the subscription, and publishers with others
/// refuse it without a message. So a subscription that has lost its last publisher is made anew; it takes any type
/// again. If one publisher is not connected while others are, a warning is needed.
class PublisherCheck {
 public:
  enum class Verdict { well, renew, warn };

  /// Any thread: the subscription has a type.
  void heard() { has_type_ = true; }
  /// Something may have changed since the last look, or is not yet clear. Changes that cannot be seen from here, such
  /// as a further publisher of another type, are found by an occasional look.
  bool wants_look(unsigned connected) {
    if (connected > 0) has_type_ = true;
    return connected != connected_ || (connected == 0 && has_type_) || (missing_ > 0 && !warned_);
  }
  /// @param published nodes that publish it, as far as the master knows
  /// @param connected those that are connected
  /// @return renew: the subscription is to be made anew; warn: a warning is to be logged, once
  Verdict look(unsigned published, unsigned connected) {
    connected_ = connected;
    missing_ = published > connected ? missing_ + 1 : 0;
    if (missing_ == 0) warned_ = false;
    alone_ = connected == 0 && (published > 0 || has_type_) ? alone_ + 1 : 0;
    if (alone_ >= kLooks) {
      alone_ = missing_ = 0;
      has_type_ = false;
      return Verdict::renew;
    }
    if (connected == 0 || missing_ < kLooks || std::exchange(warned_, true)) return Verdict::well;
    return Verdict::warn;
  }

 private:
  // A publisher that has just come is not yet connected, and of one that has just gone messages may still wait.
  static constexpr unsigned kLooks = 2;

  std::atomic<bool> has_type_{false};
  unsigned connected_ = 0;  ///< at the last look
  unsigned missing_ = 0;    ///< looks in a row at which a publisher was there, and not connected
  bool warned_ = false;     ///< of those
  unsigned alone_ = 0;      ///< looks in a row at which none was connected, though there is or was one
};

/// A ROS topic of any type, subscribed here and sent to the node that the configuration names. Its type may change: the
/// publisher may be replaced by one of another type or definition, which would refuse a plain subscription of roscpp.
class TopicIn {
 public:
  TopicIn(ros::NodeHandle& nodes, std::uint8_t number, const config::TopicConfig& topic, RingPort& port,
          Counters& counters);

  /// Any thread: the CPU of the node this topic goes to has restarted.
  void far_side_restarted();
  const config::TopicConfig& topic() const { return topic_; }
  /// The input's, as the master has it.
  const std::string& full_name() const { return full_name_; }
  /// One thread: the master should be asked how many nodes publish it. (PublisherLook)
  bool wants_look() { return check_.wants_look(subscriber_.getNumPublishers()); }
  /// The same thread: takes the number of publishers that the master knows.
  void look(unsigned published);

 private:
  using Event = ros::MessageEvent<topic_tools::ShapeShifter const>;
  void on_message(const Event& event);
  void take_type(const payload::Announcement& type);
  void renew();
  void warn_too_large(std::size_t bytes);
  void hand_over();

  config::TopicConfig topic_;
  RingPort& port_;
  Counters& counters_;
  TopicSender sender_;  // as the next, ring thread only
  process::Throttle too_large_{std::chrono::seconds(10)};
  std::mutex mutex_;
  std::deque<TopicMessage> handed_in_;  // at most topic_.queue
  PublisherCheck check_;
  std::string datatype_, md5sum_;  ///< of the last message
  ros::NodeHandle nodes_;
  std::string full_name_;
  DirectQueue at_once_;
  ros::SubscribeOptions options_;
  ros::Subscriber subscriber_;  ///< after the constructor look()'s thread alone; last: its callback uses the others
};

/// Asks the master how many nodes publish the topics of each TopicIn: once a second if a TopicIn wants to know, else
/// every ten seconds, to spare the master. It has a thread of its own, since an unreachable master does not answer for
/// minutes, and the other threads are the CPU's.
class PublisherLook {
 public:
  /// @param topics outlive this
  PublisherLook(const ros::NodeHandle& nodes, const std::vector<std::unique_ptr<TopicIn>>& topics);
  ~PublisherLook();

 private:
  void look();

  const std::vector<std::unique_ptr<TopicIn>>& topics_;
  ros::CallbackQueue queue_;
  ros::NodeHandle nodes_;
  ros::AsyncSpinner thread_;
  ros::SteadyTimer timer_;
  unsigned passed_over_ = 0;  ///< turns in which nobody was asked
};

}  // namespace limb_ring::bridge
