// Answers of a daemon that is not ours, or that has another version.
#include "ros_bridge/status_out.h"

#include <gmock/gmock.h>

#include <functional>
#include <future>

#include "client/fake_daemon.h"
#include "ros/small_robot.h"
#include "ros/stopped_holder.h"
#include "support/own_folder.h"

namespace limb_ring::bridge {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A row of the body, with these members beside what every row has.
std::string row(const std::string& members) {
  return R"({"id": 0, "name": "body", "state": "up", "cpu": {"state": "none"}, )" + members + "}";
}

class Watching : public test::OwnFolder {
 protected:
  /// Asks all nodes; that of the body answers this, nobody else is there.
  std::vector<NodeStatus> poll(const std::string& answer) {
    RingWatch watch(ring_, own());
    std::vector<NodeStatus> nodes;
    answered({answer}, [&] { nodes = watch.poll(); });
    return nodes;
  }
  /// Polls as often as there are answers of the body: the nodes whose CPU was started again, by then.
  std::vector<std::uint8_t> restarted_after(const std::vector<std::string>& answers) {
    RingWatch watch(ring_, own());
    answered(answers, [&] {
      for (std::size_t i = 0; i < answers.size(); ++i) watch.poll();
    });
    return watch.take_restarted();
  }

 private:
  static void answered(const std::vector<std::string>& answers, const std::function<void()>& polls) {
    test::FakeDaemon daemon("small", "0");
    auto all = std::async(std::launch::async, [&] {
      daemon.accept();  // who looks whether it is frozen, as it has no lock file
      daemon.hang_up();
      daemon.welcome();
      std::uint32_t token = 0;
      for (const std::string& answer : answers) {
        std::string heard;
        while (heard.find("status") == std::string::npos)
          for (const std::uint8_t byte : daemon.hear(1)) heard += static_cast<char>(byte);
        daemon.say(Reply{++token, answer});
      }
    });
    polls();
  }
  static ConnectOptions own() {
    ConnectOptions options;
    options.ring = "small";
    options.node = "body";
    return options;
  }

 protected:
  const config::RingConfig ring_ = small_robot();
};

TEST_F(Watching, AFrozenDaemonIsNotAsked) {
  const StoppedHolder holder(ring_.nodes[1]);
  const test::FakeDaemon frozen("small", std::to_string(ring_.nodes[1].id));
  EXPECT_EQ(poll(row(R"("heard": [])"))[1].state, "down");
  EXPECT_FALSE(frozen.is_tried());
}

TEST_F(Watching, AStatusIsTakenAsItIsDocumented) {
  const auto nodes = poll(row(R"("pid": 4711, "heard": [{"id": 7, "age_ms": 1}])"));
  ASSERT_EQ(nodes.size(), 3u);
  EXPECT_EQ(nodes[0].pid, 4711);
  EXPECT_EQ(nodes[1].state, "up");
}

TEST_F(Watching, AnythingElseIsNamedAndTheNodeCountsAsSilent) {
  for (const std::string& answer : {row(R"("pid": 4711, "heard": [{"id": "knee"}])"),
                                    row(R"("pid": 4711, "heard": [{}])"), row(R"("pid": 4711, "heard": [7])"),
                                    row(R"("pid": 4711, "heard": 7)"), std::string("[4711]"), std::string("{")}) {
    ::testing::internal::CaptureStderr();
    const auto nodes = poll(answer);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("the status of node 'body' cannot be read"))
        << answer;
    ASSERT_EQ(nodes.size(), 3u) << answer;
    for (const NodeStatus& node : nodes) EXPECT_EQ(node.state, "down") << answer;
    EXPECT_EQ(nodes[0].pid, 0) << answer;
  }
}

constexpr const char* kNoAnswer = "{";
const std::string kOnce = row(R"("heard": [{"id": 7, "age_ms": 1, "boot": 1763715000000000000, "cpu_boots": 1}])");
const std::string kTwice = row(R"("heard": [{"id": 7, "age_ms": 1, "boot": 1763715000000000000, "cpu_boots": 2}])");
const std::string kStartedOver =
    row(R"("heard": [{"id": 7, "age_ms": 1, "boot": 1763715000000000001, "cpu_boots": 1}])");
const std::string kNewDaemon = row(R"("heard": [{"id": 7, "age_ms": 1, "boot": 1763715099000000001, "cpu_boots": 1}])");
const std::string kNewDaemonBeforeItsCpu =
    row(R"("heard": [{"id": 7, "age_ms": 1, "boot": 1763715099000000001, "cpu_boots": 0}])");

TEST_F(Watching, ACpuThatIsStartedAgainIsNoticedOnce) {
  EXPECT_THAT(restarted_after({kOnce, kOnce}), ElementsAre());
  EXPECT_THAT(restarted_after({kOnce, kTwice, kTwice}), ElementsAre(7));
}

TEST_F(Watching, AnOwnDaemonThatDoesNotAnswerRestartsNobody) {
  EXPECT_THAT(restarted_after({kOnce, kNoAnswer, row(R"("heard": [])"), kOnce}), ElementsAre());
}

TEST_F(Watching, ACpuThatIsStartedAgainWithItsDaemonIsNoticedOnce) {
  EXPECT_THAT(restarted_after({kOnce, kNewDaemon}), ElementsAre(7));
  EXPECT_THAT(restarted_after({kOnce, kNewDaemonBeforeItsCpu, kNewDaemon}), ElementsAre(7));
}

TEST_F(Watching, ANodeThatStartsOverKeepsItsCpu) { EXPECT_THAT(restarted_after({kOnce, kStartedOver}), ElementsAre()); }

}  // namespace
}  // namespace limb_ring::bridge
