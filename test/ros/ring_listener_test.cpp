// The listener hears of all nodes, also while one of them does not answer.
#include "ros_bridge/ring_listener.h"

#include <gtest/gtest.h>

#include <future>

#include "client/fake_daemon.h"
#include "ros/small_robot.h"
#include "ros/stopped_holder.h"
#include "support/own_folder.h"

namespace limb_ring::bridge {
namespace {

using Listening = test::OwnFolder;

TEST_F(Listening, AFrozenDaemonKeepsNobodyWaiting) {
  const config::RingConfig ring = small_robot();
  const StoppedHolder holder(ring.nodes[0]);
  const test::FakeDaemon frozen("small", ring.nodes[0].name);
  test::FakeDaemon other("small", ring.nodes[1].name);
  ConnectOptions daemon;
  daemon.ring = "small";
  const RingListener listener(all_nodes(ring), daemon, "{}", [](const auto&, const Message&) {});
  other.accept();
  EXPECT_FALSE(frozen.is_tried()) << "the other one's turn came behind it";
}

TEST_F(Listening, ADaemonThatAcceptsAndSaysNothingLeavesTheOthersTheirTurns) {
  const config::RingConfig ring = small_robot();
  test::FakeDaemon mute("small", ring.nodes[0].name), other("small", ring.nodes[1].name);
  ConnectOptions daemon;
  daemon.ring = "small";
  std::promise<bool> is_tried_again;
  int turns = 0;
  const RingListener listener(
      {&ring.nodes[0], &ring.nodes[1]}, daemon, "{}", [](const auto&, const Message&) {},
      [&](const auto&) {
        if (++turns == 1) mute.accept();
        if (turns == 3) is_tried_again.set_value(mute.is_tried());
        return false;
      });
  other.accept();
  other.say(client::Welcome{ring.nodes[1].id, ring.nodes[1].name, "small"});
  EXPECT_FALSE(is_tried_again.get_future().get()) << "between two turns of the other one";
}

TEST_F(Listening, ADaemonThatIsFoundIsAskedHowItIs) {
  const config::RingConfig ring = small_robot();
  test::FakeDaemon found("small", ring.nodes[1].name);
  ConnectOptions daemon;
  daemon.ring = "small";
  const RingListener listener(
      {&ring.nodes[1]}, daemon, "{}", [](const auto&, const Message&) {}, [](const auto&) { return false; });
  found.accept();
  found.say(client::Welcome{ring.nodes[1].id, ring.nodes[1].name, "small"});
  std::string heard;
  while (heard.find(R"({"do":"status"})") == std::string::npos)
    for (const std::uint8_t byte : found.hear(1)) heard += static_cast<char>(byte);
}

}  // namespace
}  // namespace limb_ring::bridge
