// Daemons that are connected to and do not answer.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <future>
#include <thread>

#include "client/fake_daemon.h"
#include "support/own_folder.h"
#include "support/thrown.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using ::testing::HasSubstr;

class SilentDaemons : public test::OwnFolder {
 protected:
  /// Takes who comes, and tells nobody anything. @return false if they were never all asked at the same time
  bool all_are_asked_at_once() {
    const auto guard = steady_clock::now() + std::chrono::seconds(30);
    while (steady_clock::now() < guard) {
      for (test::FakeDaemon& daemon : daemons) {
        if (!daemon.is_tried()) continue;
        daemon.hang_up();
        daemon.accept();
      }
      const auto has_client = [](const test::FakeDaemon& daemon) { return daemon.has_client(); };
      if (std::all_of(daemons.begin(), daemons.end(), has_client)) return true;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return false;
  }

  /// To the first request, once that has come.
  static void answer(test::FakeDaemon& daemon, const std::string& reply) {
    daemon.say(client::Welcome{3, "node3", "r"});
    for (std::string heard; heard.find("\"do\"") == std::string::npos;) {
      const client::Bytes more = daemon.hear(1);
      heard.append(more.begin(), more.end());
    }
    daemon.say(Reply{1, reply});
  }

  std::array<test::FakeDaemon, 4> daemons{test::FakeDaemon{"r", "0"}, test::FakeDaemon{"r", "1"},
                                          test::FakeDaemon{"r", "2"}, test::FakeDaemon{"r", "3"}};
};

TEST_F(SilentDaemons, AreAskedAtTheSameTimeAndOneThatAnswersIsEnough) {
  auto opened = std::async(std::launch::async, [] { return RingAccess::open("r"); });
  const bool at_once = all_are_asked_at_once();
  if (at_once) answer(daemons[2], R"({"nodes": [{"id": 3, "name": "node3"}]})");
  EXPECT_TRUE(at_once);
  EXPECT_EQ(opened.get().source("").name, "node3");
}

TEST_F(SilentDaemons, ThatAnswerInAnotherShapeAreNamedWithWhatToDo) {
  auto opened = std::async(std::launch::async, [] { return test::thrown<NoRing>([] { RingAccess::open("r"); }); });
  const bool at_once = all_are_asked_at_once();
  for (test::FakeDaemon& daemon : daemons)
    if (at_once) answer(daemon, R"({"nodes": {"0": "node0"}})");
  EXPECT_THAT(opened.get(), HasSubstr("unexpected reply from its daemon: 'nodes' is not a list; both "
                                      "have to be of one version of limb_ring"));
}

// On a machine so busy that the time is over before anybody is asked, they are asked again with more of it.
TEST_F(SilentDaemons, AreWaitedForUntilTheDeadline) {
  std::string why;
  for (milliseconds time{100}; !daemons[0].is_tried(); time *= 2)
    why = test::thrown<NoRing>([&] { RingAccess::open("r", {}, steady_clock::now() + time); });
  EXPECT_THAT(why, HasSubstr("node 0 does not answer"));
}

TEST_F(SilentDaemons, AreNamedIfTheyHaveNotAnsweredByTheDeadline) {
  const std::vector<NodeName> nodes{{0, "node0"}, {1, "node1"}};
  const auto not_asked = [](const ask::Answer& answer) {
    return answer.why_not == "it was not asked: no time was left";
  };
  std::vector<ask::Answer> answers;
  milliseconds time{100};
  do {
    answers = ask_all("r", nodes, {{"do", "status"}}, steady_clock::now() + time);
    time *= 2;
  } while (std::any_of(answers.begin(), answers.end(), not_asked));
  for (const ask::Answer& answer : answers) EXPECT_THAT(answer.why_not, HasSubstr("its daemon did not answer within"));
}

TEST_F(SilentDaemons, AreNotAskedWhenTheDeadlineIsOver) {
  const auto answers = ask_all("r", {{0, "node0"}}, {{"do", "status"}}, steady_clock::now());
  EXPECT_EQ(answers.front().why_not, "it was not asked: no time was left");
  EXPECT_FALSE(daemons[0].is_tried());
}

}  // namespace
}  // namespace limb_ring::ringctl
