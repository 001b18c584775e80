// What a daemon answers that is none of ours, or of another version.
#include "ros_bridge/ring_watch.h"

#include <gmock/gmock.h>

#include <future>

#include "client/fake_daemon.h"
#include "ros/small_robot.h"
#include "ros/stopped_holder.h"
#include "support/own_folder.h"

namespace limb_ring::bridge {
namespace {

using ::testing::HasSubstr;

class Watching : public test::OwnFolder {
 protected:
  /// Asks all nodes; that of the body answers this, nobody else is there.
  std::vector<NodeStatus> poll(const std::string& answer) {
    test::FakeDaemon daemon("small", "body");
    auto answered = std::async(std::launch::async, [&] {
      daemon.welcome();
      std::string heard;
      while (heard.find("status") == std::string::npos)
        for (const std::uint8_t byte : daemon.hear(1)) heard += static_cast<char>(byte);
      daemon.say(Reply{1, answer});
    });
    ConnectOptions own;
    own.ring = "small";
    own.node = "body";
    return RingWatch(ring_, own).poll();
  }

  const config::RingConfig ring_ = small_robot();
};

TEST_F(Watching, AFrozenDaemonIsNotAsked) {
  const StoppedHolder holder(ring_.nodes[1]);
  const test::FakeDaemon frozen("small", ring_.nodes[1].name);
  EXPECT_EQ(poll(R"({"state": "up", "heard": []})")[1].state, "down");
  EXPECT_FALSE(frozen.is_tried());
}

TEST_F(Watching, AStatusIsTakenAsItIsDocumented) {
  const auto nodes = poll(R"({"state": "up", "pid": 4711, "heard": [{"id": 7, "age_ms": 1}]})");
  ASSERT_EQ(nodes.size(), 3u);
  EXPECT_EQ(nodes[0].pid, 4711);
  EXPECT_EQ(nodes[1].state, "up");
}

TEST_F(Watching, AnythingElseIsNamedAndTheNodeCountsAsSilent) {
  for (const char* answer : {R"({"pid": 4711, "heard": [{"id": "knee"}]})", R"({"pid": 4711, "heard": [{}]})",
                             R"({"pid": 4711, "heard": [7]})", R"({"pid": 4711, "heard": 7})", "[4711]", "{"}) {
    ::testing::internal::CaptureStderr();
    const auto nodes = poll(answer);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("node 'body' answers no status")) << answer;
    ASSERT_EQ(nodes.size(), 3u) << answer;
    for (const NodeStatus& node : nodes) EXPECT_EQ(node.state, "down") << answer;
    EXPECT_EQ(nodes[0].pid, 0) << answer;
  }
}

}  // namespace
}  // namespace limb_ring::bridge
