#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>

#include "io/link_rig.h"

namespace limb_ring::link {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Bypass : OnEveryTransport {
  LinkRig rig{4, GetParam()};

  void close_ring() {
    rig.start_all();
    ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  }
  void write_one(std::size_t node) {
    wire::SliceWriter writer;
    put_whole(writer, 20, 1);
    rig.node(node).output->write(writer.view());
  }
};
LIMB_RING_ON_EVERY_TRANSPORT(Bypass);

TEST_P(Bypass, GoesAroundANodeThatEndsAndBackWhenItReturns) {
  close_ring();
  rig.end(1);
  ASSERT_TRUE(rig.until([&] { return rig.linked(0, 2); }));
  EXPECT_TRUE(rig.linked(2, 3) && rig.linked(3, 0));
  rig.start(1);
  ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
}

TEST_P(Bypass, GoesAroundTwoNodesAndBackInEitherOrder) {
  for (const std::size_t first : {1u, 2u}) {
    LinkRig ring(4, GetParam());
    ring.start_all();
    ASSERT_TRUE(ring.until([&] { return ring.whole(); }));
    ring.end(1);
    ring.end(2);
    ASSERT_TRUE(ring.until([&] { return ring.linked(0, 3); }));
    ring.start(first);
    ASSERT_TRUE(ring.until([&] { return ring.linked(0, first) && ring.linked(first, 3); }));
    ring.start(3 - first);
    ASSERT_TRUE(ring.until([&] { return ring.whole(); }));
  }
}

TEST_P(Bypass, GoesAroundAFrozenNodeAndTheRingIsWholeAfterTheThaw) {
  close_ring();
  rig.node(2).frozen = true;
  ASSERT_TRUE(rig.until([&] { return rig.linked(1, 3); }));
  EXPECT_THAT(rig.node(1).said.log, Contains(HasSubstr("silent")));
  EXPECT_THAT(rig.node(3).heard.log, Contains(HasSubstr("lost")));
  rig.run_for(milliseconds(200));
  EXPECT_TRUE(rig.linked(1, 3)) << "a frozen node's kernel accepts, but that is no answer";
  rig.node(2).frozen = false;
  ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  rig.run_for(milliseconds(300));
  EXPECT_TRUE(rig.whole()) << "it stays whole";
}

// It is old: what was sent once more has gone round without that node. (protocol.md section 6.10)
TEST_P(Bypass, AThawedNodeTakesNothingOfWhatWaitedForItWhenItWasGivenUp) {
  close_ring();
  rig.node(1).frozen = true;
  rig.node(1).heard.slices.clear();
  write_one(0);
  ASSERT_TRUE(rig.until([&] { return rig.linked(0, 2); }));
  rig.node(1).frozen = false;
  ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  EXPECT_THAT(rig.node(1).heard.slices, IsEmpty());
  EXPECT_EQ(rig.node(1).input->counters().given_up, 1u);
}

TEST_P(Bypass, ANodeThatStoodStillTakesWhatWaitedForItWhenItWasNotGivenUp) {
  close_ring();
  rig.node(1).heard.slices.clear();
  for (std::size_t i = 0; i < rig.size(); ++i) rig.node(i).frozen = true;
  write_one(0);
  rig.run_for(LinkRig::kQuick.silence);
  for (std::size_t i = 0; i < rig.size(); ++i) rig.node(i).frozen = false;
  ASSERT_TRUE(rig.until([&] { return !rig.node(1).heard.slices.empty(); }));
  EXPECT_EQ(rig.node(1).input->counters().given_up, 0u);
  EXPECT_TRUE(rig.whole());
}

TEST_P(Bypass, DoesNotFlapWhenALongFrozenNodeThaws) {
  close_ring();
  rig.node(1).frozen = true;
  ASSERT_TRUE(rig.until([&] { return rig.linked(0, 2); }));
  rig.run_for(milliseconds(2500));  // long enough for probes to be given up and begun again
  rig.node(1).heard.log.clear();
  rig.node(1).frozen = false;
  ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  rig.run_for(milliseconds(100));
  const auto ups = std::count(rig.node(1).heard.log.begin(), rig.node(1).heard.log.end(), "up 0");
  EXPECT_LE(ups, 2) << testing::PrintToString(rig.node(1).heard.log);
}

TEST_P(Bypass, SurvivesAFreezeOfEverybodyAtOnce) {
  close_ring();
  for (std::size_t i = 0; i < 4; ++i) rig.node(i).frozen = true;
  rig.run_for(milliseconds(150));
  for (std::size_t i = 0; i < 4; ++i) rig.node(i).frozen = false;
  rig.run_for(milliseconds(100));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(rig.node(i).said.log.size(), 1u) << "node " << i << " blamed others for its sleep";
  }
  EXPECT_TRUE(rig.whole());
}

TEST_P(Bypass, EndsAloneAndComesBack) {
  close_ring();
  for (const std::size_t i : {1u, 2u, 3u}) rig.end(i);
  ASSERT_TRUE(rig.until([&] { return rig.linked(0, 0); }));
  for (const std::size_t i : {3u, 1u, 2u}) rig.start(i);
  EXPECT_TRUE(rig.until([&] { return rig.whole(); }));
}

TEST_P(Bypass, TakesTheSameNodeAgainAfterARestart) {
  close_ring();
  rig.end(0);
  rig.start(0);
  ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  wire::SliceWriter writer;
  put_whole(writer, 524, 9);
  rig.node(0).output->write(writer.view());
  EXPECT_TRUE(rig.until([&] { return rig.node(1).heard.slices.size() == 1; }));
}

TEST_P(Bypass, GoesAroundAKilledProcess) {
  const pid_t child = ::fork();
  if (child == 0) {
    rig.start(1);
    rig.node(1).io.run();
    ::_exit(0);
  }
  ASSERT_GT(child, 0);
  for (const std::size_t i : {0u, 2u, 3u}) rig.start(i);
  const bool closed = rig.until([&] {
    return rig.node(0).output->up() && rig.node(0).output->to() == 1 && rig.node(2).input->from() == 1 &&
           rig.linked(2, 3) && rig.linked(3, 0);
  });
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  ASSERT_TRUE(closed);
  ASSERT_TRUE(rig.until([&] { return rig.linked(0, 2); }));
  rig.start(1);
  EXPECT_TRUE(rig.until([&] { return rig.whole(); })) << "its old socket is replaced";
}

}  // namespace
}  // namespace limb_ring::link
