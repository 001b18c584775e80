// relay_chain_ends FIRST LAST SIZE SECONDS: both ends of a chain of topic_tools/relay nodes.
// Publishes SIZE bytes to FIRST, one message at a time, waits for each at LAST, and prints what
// that took as JSON.
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/UInt8MultiArray.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/measurement.h"
#include "wire/bytes.h"

namespace {

using limb_ring::bench::Samples;

class ChainEnds {
 public:
  ChainEnds(const std::string& first, const std::string& last, std::size_t size, double seconds) : samples_(seconds) {
    message_.data.resize(size);
    publisher_ = node_.advertise<std_msgs::UInt8MultiArray>(first, 10);
    subscriber_ = node_.subscribe(last, 10, &ChainEnds::on_message, this, ros::TransportHints().tcpNoDelay());
    knocking_ = node_.createSteadyTimer(ros::WallDuration(0.1), &ChainEnds::knock, this);
  }

  bool done() const { return done_; }
  nlohmann::json report() {
    const auto m = samples_.measurement();
    return {{"p50", m.round_trip_us.p50},
            {"p99", m.round_trip_us.p99},
            {"max", m.round_trip_us.max},
            {"packets", m.packets},
            {"packets_per_second", m.packets_per_second}};
  }

 private:
  void publish() {
    sent_ = Samples::Clock::now();
    limb_ring::wire::store_u32(message_.data.data(), ++number_);
    publisher_.publish(message_);
  }

  // A relay connects to the next one only when a first message has come, so we publish until one has passed all.
  void knock(const ros::SteadyTimerEvent&) {
    if (!running_ || Samples::Clock::now() - sent_ > std::chrono::seconds(1)) publish();
  }

  void on_message(const std_msgs::UInt8MultiArray::ConstPtr& message) {
    const auto now = Samples::Clock::now();
    if (limb_ring::wire::load_u32(message->data.data()) != number_) return;  // from before all relays were connected
    if (running_)
      done_ = !samples_.lap(now);
    else
      samples_.begin(now);
    running_ = true;
    if (!done_) publish();
  }

  Samples samples_;
  std_msgs::UInt8MultiArray message_;
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
  ros::SteadyTimer knocking_;
  Samples::Clock::time_point sent_;
  std::uint32_t number_ = 0;
  bool running_ = false;
  bool done_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "relay_chain_ends");
  if (argc != 5) {
    std::cerr << "relay_chain_ends FIRST LAST SIZE SECONDS\n";
    return 2;
  }
  ChainEnds ends(argv[1], argv[2], std::strtoul(argv[3], nullptr, 10), std::strtod(argv[4], nullptr));
  while (ros::ok() && !ends.done()) ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  std::cout << ends.report() << std::endl;
  return 0;
}
