// `ringctl up` and `down` with daemons that are no daemons, so that what goes wrong is chosen.
#include <gmock/gmock.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <functional>

#include "app/ringctl/ring_plan.h"
#include "app/ringctl/signal_wait.h"
#include "app/ringctl/own_folder.h"
#include "live/lock_files.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::ringctl {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class Start : public OwnFolder {
 protected:
  Start() : path_(std::getenv("PATH")) {
    ::setenv("PATH", (folder + ":" + path_).c_str(), 1);
    plan.ring = "legs";
    plan.nodes = {{{0, "body"}, false}, {{7, "left_knee"}, false}};
  }
  ~Start() override { ::setenv("PATH", path_.c_str(), 1); }

  /// The program that is started instead of ringd.
  void ringd_is(const std::string& script) {
    ::chmod(write("ringd", "#!/bin/sh\n" + script).c_str(), 0700);
  }
  bool until(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + 20s;
    while (!condition() && std::chrono::steady_clock::now() < deadline) signals.next(10ms);
    return condition();
  }

  RingPlan plan;
  SignalWait signals;
  live::LaunchedRing::Wait wait = [this](auto time) { return signals.asked_to_end(time); };

 private:
  std::string path_;
};

TEST_F(Start, DaemonThatEndsIsNamedWithTheLastLinesOfItsLog) {
  ringd_is("echo first; echo node is held by pid 12 >&2; exit 3");
  live::LaunchedRing daemons(launch_request(plan, process::Lifetime::its_own, true));
  ASSERT_TRUE(until([&] { return daemons.reap(), !daemons.any_running(); }));
  EXPECT_THAT(daemons.all()[1].exit_reason(),
              AllOf(HasSubstr("node 7 (left_knee)"), HasSubstr("exit 3"),
                    HasSubstr("held by pid 12")));
}

TEST_F(Start, DaemonsThatIgnoreSigtermAreKilled) {
  ringd_is("trap '' TERM; kill -STOP $$; while :; do sleep 1; done");
  live::LaunchedRing daemons(launch_request(plan, process::Lifetime::asked_to_end, false));
  daemons.end(wait, 50ms);
  EXPECT_FALSE(daemons.any_running());
}

TEST_F(Start, SecondRequestToEndKillsAtOnce) {
  ringd_is("trap '' TERM INT; kill -STOP $$; while :; do sleep 1; done");
  live::LaunchedRing daemons(launch_request(plan, process::Lifetime::asked_to_end, false));
  ::raise(SIGINT);
  daemons.end(wait, 1h);
  EXPECT_FALSE(daemons.any_running());
}

/// As a daemon does: holds DIRECTORY/ID.lock, with its pid in it.
class HeldLock {
 public:
  explicit HeldLock(const std::string& path, pid_t pid) {
    std::ofstream(path) << pid << '\n';
    file_.reset(::open(path.c_str(), O_RDWR | O_CLOEXEC));
    ::flock(file_.get(), LOCK_EX | LOCK_NB);
  }

 private:
  process::UniqueFd file_;
};

TEST_F(Start, HeldNodesAreThoseWhoseHolderLives) {
  const std::string ring = make_ring_directory("legs");
  std::ofstream(ring + "/3.lock") << 4711 << '\n';
  const HeldLock held(ring + "/7.lock", 12);
  const auto nodes = live::held_nodes(ring);
  ASSERT_THAT(nodes, SizeIs(1));
  EXPECT_EQ(nodes[0].pid, 12);
}

TEST_F(Start, LeftoversGoWithTheirFolder) {
  const std::string ring = make_ring_directory("legs");
  for (const char* name : {"3.boot", "3.lock", "3.host", "3.link", "3.log"}) std::ofstream(ring + "/" + name);
  std::filesystem::create_symlink("3.host", ring + "/left_knee.host");
  live::remove_leftovers(ring);
  EXPECT_FALSE(std::filesystem::exists(ring));
}

TEST_F(Start, LeftoversOfOthersStay) {
  const std::string ring = make_ring_directory("legs");
  std::ofstream(ring + "/notes.txt") << "mine";
  live::remove_leftovers(ring);
  EXPECT_TRUE(std::filesystem::exists(ring + "/notes.txt"));
}

TEST_F(Start, RingThatIsNotThereHoldsNothing) {
  EXPECT_THAT(live::held_nodes(ring_directory("nowhere")), IsEmpty());
}

}  // namespace
}  // namespace limb_ring::ringctl
