// A ring is launched with daemons that are not daemons, so that what goes wrong is chosen.
#include "ring/launched_ring.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <cerrno>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <thread>

#include "limb_ring/ring_directory.h"
#include "support/node_literal.h"
#include "support/own_folder.h"

namespace limb_ring::live {
namespace {

using namespace std::chrono_literals;
using process::Lifetime;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Launched : public test::OwnFolder {
 protected:
  Launched() : path_(std::getenv("PATH")) {
    ::setenv("PATH", (folder + ":" + path_).c_str(), 1);
    request.ring = "legs";
    request.nodes = {{0_id, "body", {}}, {7_id, "left_knee", {}}};
  }
  ~Launched() override { ::setenv("PATH", path_.c_str(), 1); }

  /// The program that is started instead of ringd.
  void ringd_is(const std::string& script) { ::chmod(write("ringd", "#!/bin/sh\n" + script).c_str(), 0700); }
  static bool wait(std::chrono::milliseconds time) {
    std::this_thread::sleep_for(time);
    return false;
  }
  bool until(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + 20s;
    while (!condition() && std::chrono::steady_clock::now() < deadline) wait(10ms);
    return condition();
  }

  LaunchRequest request;

 private:
  std::string path_;
};

TEST_F(Launched, DaemonThatEndsIsNamedWithTheLastLinesOfItsLog) {
  ringd_is("echo first; echo node is held by pid 12 >&2; exit 3");
  request.lifetime = Lifetime::its_own;
  LaunchedRing ring(request);
  ASSERT_TRUE(until([&] { return ring.reap(), !ring.any_running(); }));
  EXPECT_THAT(ring.all()[1].exit_reason(),
              AllOf(HasSubstr("node 7 (left_knee)"), HasSubstr("exit 3"), HasSubstr("held by pid 12")));
}

TEST_F(Launched, DaemonThatEndedIsReportedOnceAndStartedAgainAsBefore) {
  ringd_is("exit 0");
  request.nodes.resize(1);
  LaunchedRing ring(request);
  std::size_t reported = 0;
  ASSERT_TRUE(until([&] { return reported += ring.reap().size(), reported != 0; }));
  EXPECT_TRUE(ring.reap().empty());
  ring.start_again(0);
  EXPECT_TRUE(ring.any_running());
  EXPECT_TRUE(until([&] { return ring.reap(), !ring.any_running(); }));
}

TEST_F(Launched, EachDaemonHasItsOwnArgumentsAndLog) {
  ringd_is("echo arguments: $*");
  request.nodes = {{0_id, "body", {"--node", "0"}}, {7_id, "left_knee", {"--node", "7"}}};
  LaunchedRing ring(request);
  ASSERT_TRUE(until([&] { return ring.reap(), !ring.any_running(); }));
  EXPECT_EQ(ring.all()[0].program.output(), "arguments: --node 0\n");
  EXPECT_EQ(ring.all()[1].last_lines(), "\n  arguments: --node 7");
}

TEST_F(Launched, ADaemonThatSaidNothingHasItsEmptyLogNamedAndNothingWrittenThere) {
  ringd_is("exit 1");
  request.nodes.resize(1);
  LaunchedRing ring(request);
  ASSERT_TRUE(until([&] { return ring.reap(), !ring.any_running(); }));
  EXPECT_THAT(ring.all()[0].exit_reason(), HasSubstr(".log is empty"));
  EXPECT_EQ(ring.all()[0].program.output(), "");
}

TEST_F(Launched, DaemonsThatIgnoreSigtermAreKilled) {
  ringd_is("trap '' TERM; kill -STOP $$; while :; do sleep 1; done");
  LaunchedRing ring(request);
  ring.end(wait, 50ms);
  EXPECT_FALSE(ring.any_running());
}

TEST_F(Launched, ARequestToEndAtOnceKillsAtOnce) {
  ringd_is("trap '' TERM; kill -STOP $$; while :; do sleep 1; done");
  LaunchedRing ring(request);
  ring.end([](auto time) { return wait(time), true; }, 1h);
  EXPECT_FALSE(ring.any_running());
}

TEST_F(Launched, WithoutRingdThereIsNoRing) {
  ::setenv("PATH", folder.c_str(), 1);
  try {
    LaunchedRing ring(request);
    FAIL() << "it was started";
  } catch (const std::runtime_error& problem) {
    EXPECT_THAT(problem.what(), HasSubstr("no program ringd"));
  }
}

TEST_F(Launched, IfOneCannotBeStartedThoseBeforeItHaveEnded) {
  ringd_is("sleep 1000");
  request.lifetime = Lifetime::its_own;
  std::filesystem::create_directory(make_ring_directory(request.ring) + "/7.log");
  EXPECT_THROW(LaunchedRing{request}, std::runtime_error);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a child still runs";
  EXPECT_EQ(errno, ECHILD);
}

}  // namespace
}  // namespace limb_ring::live
