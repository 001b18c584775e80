#pragma once

#include <ros/ros.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/payload/reassembler.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/ring_port.h"

namespace limb_ring::bridge {

/// A thread for work that may take long, one piece after the other.
class WorkThread {
 public:
  WorkThread() : thread_([this] { run(); }) {}
  WorkThread(const WorkThread&) = delete;
  WorkThread& operator=(const WorkThread&) = delete;
  /// Waits for the work under way. What still waits is not done.
  ~WorkThread() {
    {
      std::lock_guard<std::mutex> lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_all();
    thread_.join();
  }
  void post(std::function<void()> work) {
    {
      std::lock_guard<std::mutex> lock(mutex_);
      work_.push_back(std::move(work));
    }
    wake_.notify_all();
  }

 private:
  void run() {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
      wake_.wait(lock, [this] { return stopping_ || !work_.empty(); });
      if (stopping_) return;
      const auto work = std::move(work_.front());
      work_.pop_front();
      lock.unlock();
      work();
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> work_;
  bool stopping_ = false;
  std::thread thread_;
};

/// ROS topics of any type that come over the ring to this node, reassembled and published byte for byte as they were. A
/// topic is advertised when its type is announced, in a separate thread: if the master is gone, this waits until it is
/// back. Meanwhile the topic's messages wait, at most as many as its queue holds.
class TopicOut {
 public:
  TopicOut(ros::NodeHandle& nodes, const config::RingConfig& ring, std::uint8_t own_id, RingPort& port,
           Counters& counters);

 private:
  struct Output {
    config::TopicConfig topic;
    std::optional<payload::Announcement> type;  ///< announced last
    ros::Publisher publisher;                   ///< of that type; none until it is advertised
    bool is_advertising = false;                ///< of that type or of an earlier one
    std::deque<std::vector<std::uint8_t>> waiting;
  };
  struct Advertised {
    Output* output;
    ros::Publisher publisher;
    payload::Announcement type;
  };
  void on_packet(const Packet& packet);
  void on_announced(Output& output, const payload::Announcement& type);
  void on_message(Output& output, std::vector<std::uint8_t> bytes);
  void publish(Output& output, std::vector<std::uint8_t> bytes);
  /// The oldest of those that wait.
  void drop(Output& output, std::size_t oldest);
  /// @param before its publisher of another type, which ends
  void advertise(Output& output, ros::Publisher before);
  void take_advertised();
  void each_second();

  ros::NodeHandle nodes_;
  RingPort& port_;
  Counters& counters_;
  payload::Reassembler reassembler_;
  std::map<std::uint8_t, Output> outputs_;  // by the topic's place in the configuration
  std::mutex mutex_;
  std::vector<Advertised> advertised_;  ///< and not yet taken by the ring thread
  WorkThread advertiser_;               // last: it uses the others
};

}  // namespace limb_ring::bridge
