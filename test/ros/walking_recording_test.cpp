// The recorded walk of a humanoid, sent by all its nodes at once in place of their firmware,
// arrives at the bridge sample for sample.
#include <gmock/gmock.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <list>
#include <thread>

#include "config/load_ring.h"
#include "limb_ring/host_port.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/packet_type.h"
#include "ros/walking_recording.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;

constexpr std::int64_t kWarmUpStamp = 1;
constexpr std::uint8_t kBody = 0;
constexpr auto kGuard = 60s;

/// One node: sends what was recorded of its joints, and keeps what the bridge says it sent.
class RecordedNode {
 public:
  RecordedNode(ros::NodeHandle& ros, const std::string& ring, const config::NodeConfig& config)
      : config_(config), port_(HostPort::connect(door(ring, config.name))) {
    subscriber_ = ros.subscribe<sensor_msgs::JointState>("states/" + config.name, 0,
                                                         [this](const sensor_msgs::JointState::ConstPtr& message) {
                                                           if (message->header.stamp.toNSec() == kWarmUpStamp)
                                                             warm_ = true;
                                                           else
                                                             received_.push_back(*message);
                                                         });
  }

  bool is_warm() const { return warm_; }
  const std::string& name() const { return config_.name; }
  const std::vector<sensor_msgs::JointState>& received() const { return received_; }

  void send_warm_up() { send(kWarmUpStamp, {config_.joints.size(), payload::JointState::Joint{}}); }
  void send_sample(const WalkingRecording& recording, std::size_t row) {
    std::vector<payload::JointState::Joint> joints;
    for (const auto& joint : config_.joints)
      joints.push_back({recording.position(row, joint.name), recording.velocity(row, joint.name), 0});
    send(recording.stamp_ns(row), std::move(joints));
  }
  /// How the last send ended.
  Outcome outcome() { return port_.wait(token_, 20s).outcome; }

  void expect_sample(const WalkingRecording& recording, std::size_t row) const {
    const auto& message = received_.at(row);
    ASSERT_EQ(static_cast<std::int64_t>(message.header.stamp.toNSec()), recording.stamp_ns(row));
    ASSERT_EQ(message.name.size(), config_.joints.size());
    for (std::size_t i = 0; i < message.name.size(); ++i) {
      const auto& joint = config_.joints[i].name;
      ASSERT_EQ(message.name[i], joint);
      expect_exact(message.position[i], recording.position(row, joint));
      expect_exact(message.velocity[i], recording.velocity(row, joint));
    }
  }

 private:
  static ConnectOptions door(const std::string& ring, const std::string& node) {
    ConnectOptions options;
    options.ring = ring;
    options.node = node;
    options.role = Role::cpu;
    options.timeout = kGuard;
    return options;
  }
  void send(std::int64_t stamp_ns, std::vector<payload::JointState::Joint> joints) {
    payload::JointState state;
    state.sequence = sequence_++;
    state.stamp_ns = stamp_ns;
    state.joints = std::move(joints);
    token_ = port_.send(kBody, *payload::encode(state), 0, payload::kJointChannel);
  }
  // The compact form's resolution is 1e-6: what arrives is the nearest such number, exactly.
  static void expect_exact(double received, double recorded) {
    EXPECT_EQ(received, static_cast<double>(std::llround(recorded * 1e6)) / 1e6);
    EXPECT_NEAR(received, recorded, 0.5000001e-6);
  }

  config::NodeConfig config_;
  HostPort port_;
  ros::Subscriber subscriber_;
  std::uint16_t sequence_ = 0;
  std::uint32_t token_ = 0;
  bool warm_ = false;
  std::vector<sensor_msgs::JointState> received_;
};

class WalkingAcrossTheRing : public ::testing::Test {
 protected:
  WalkingAcrossTheRing() {
    const auto ring = own_.param("ring", std::string());
    for (const auto& node : config::load_ring(own_.param("config", std::string())).nodes)
      if (!node.joints.empty()) nodes_.emplace_back(ros_, ring, node);
  }
  template <typename Condition>
  bool spin_until(
      Condition condition, const std::function<void()>& meanwhile = [] {}) {
    const auto deadline = steady_clock::now() + kGuard;
    while (!condition() && steady_clock::now() < deadline) {
      meanwhile();
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
    }
    return condition();
  }
  bool all(bool (RecordedNode::*is_so)() const) const {
    return std::all_of(nodes_.begin(), nodes_.end(), [&](const auto& node) { return (node.*is_so)(); });
  }
  // Until the bridge knows its listener, samples come out nowhere.
  void warm_up() {
    ASSERT_TRUE(spin_until([&] { return all(&RecordedNode::is_warm); },
                           [&] {
                             for (auto& node : nodes_) node.send_warm_up();
                             for (auto& node : nodes_) node.outcome();
                           }));
  }
  // At the recorded pace; every send is answered before the next of that node.
  void play(const WalkingRecording& recording) {
    const auto start = steady_clock::now();
    for (std::size_t row = 0; row < recording.size(); ++row) {
      std::this_thread::sleep_until(start + nanoseconds(recording.stamp_ns(row) - recording.stamp_ns(0)));
      for (auto& node : nodes_) node.send_sample(recording, row);
      for (auto& node : nodes_) ASSERT_EQ(node.outcome(), Outcome::delivered) << node.name();
      ros::getGlobalCallbackQueue()->callAvailable();
    }
  }

  ros::NodeHandle ros_, own_{"~"};
  std::list<RecordedNode> nodes_;
};

TEST_F(WalkingAcrossTheRing, ArrivesSampleForSampleInOrderAndExactInTheCompactForm) {
  const WalkingRecording recording(own_.param("recording", std::string()));
  ASSERT_GT(recording.size(), 1000u);
  warm_up();
  play(recording);
  for (const auto& node : nodes_) {
    ASSERT_TRUE(spin_until([&] { return node.received().size() >= recording.size(); }))
        << node.name() << ": " << node.received().size() << " of " << recording.size();
    EXPECT_EQ(node.received().size(), recording.size()) << node.name();
    for (std::size_t row = 0; row < recording.size(); ++row) node.expect_sample(recording, row);
  }
}

}  // namespace
}  // namespace limb_ring::bridge

int main(int argc, char** argv) {
  ros::init(argc, argv, "walking_recording_test");
  ::testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
