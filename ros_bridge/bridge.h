#pragma once

#include <ros/ros.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/throttle.h"
#include "ros_bridge/clock_follower.h"
#include "ros_bridge/command_in.h"
#include "ros_bridge/controllers.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/diagnostics_out.h"
#include "ros_bridge/events_out.h"
#include "ros_bridge/frames_out.h"
#include "ros_bridge/joint_data_out.h"
#include "ros_bridge/parameters.h"
#include "ros_bridge/ring_port.h"
#include "ros_bridge/services.h"
#include "ros_bridge/status_out.h"
#include "ros_bridge/topic_in.h"
#include "ros_bridge/topic_out.h"

namespace limb_ring::bridge {

/// Logs the interrupts that come to the bridge: at most one line a second for stops and one for all others. The topic
/// `ring_events` has each interrupt.
class InterruptLog {
 public:
  explicit InterruptLog(const config::RingConfig& ring) : ring_(ring) {}

  /// "INT2 from node head: notify; 41 more since the last such line"; nothing if none is due
  std::optional<std::string> take(const Interrupt& interrupt,
                                  process::Throttle::Clock::time_point now = process::Throttle::Clock::now());

 private:
  const config::RingConfig& ring_;
  process::Throttle stops_{std::chrono::seconds(1)}, notifies_{std::chrono::seconds(1)};
};

/// The CPU of one node of the ring, as ROS sees it: one class per direction, put together here.
///
///   ROS -> ring   CommandIn, SensorIn, TopicIn (one per topic), Services
///   ring -> ROS   JointDataOut, TopicOut, StatusOut (and with it DiagnosticsOut), EventsOut, FramesOut
class Bridge {
 public:
  Bridge(ros::NodeHandle nodes, Parameters parameters);
  ~Bridge();

 private:
  void make_topics();
  void tell_connection(const std::string& problem);
  void warn_of_absence();
  void tell_interrupt(const Interrupt& interrupt);
  void tell_time(std::chrono::nanoseconds now);
  void on_boot(std::uint8_t node);

  ros::NodeHandle nodes_;
  Parameters parameters_;
  Counters counters_;
  RingPort port_;
  JointDataOut joints_;
  TopicOut topics_out_;
  CommandIn commands_;
  std::optional<SensorIn> sensors_;
  Controllers controllers_;
  std::vector<std::unique_ptr<TopicIn>> topics_in_;
  std::optional<PublisherLook> publishers_;
  std::optional<PromisesOut> promises_;
  DiagnosticsOut diagnostics_;
  EventsOut events_;
  StatusOut status_;
  FramesOut frames_;
  InterruptLog interrupts_;  ///< ring thread
  std::unique_ptr<Services> services_;
  std::mutex absence_mutex_;
  std::string absence_;  ///< why the daemon is not connected
  std::optional<RingPort::Clock::time_point> absent_since_;
  bool told_waiting_ = false;
  ros::SteadyTimer alive_;
  ros::Publisher clock_;  ///< ring thread
  std::optional<ClockFollower> follower_;
};

}  // namespace limb_ring::bridge
