#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <future>

#include "client/fake_daemon.h"
#include "limb_ring/host_port.h"
#include "support/runtime_folder.h"
#include "support/thrown.h"

namespace limb_ring {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;

ConnectOptions options(const std::string& ring, const std::string& node) {
  ConnectOptions made;
  made.ring = ring;
  made.node = node;
  made.timeout = milliseconds{0};
  return made;
}

void expect_refusal(const ConnectOptions& how, const testing::Matcher<const std::string&>& what) {
  EXPECT_THAT(test::thrown<HostPortError>([&] { HostPort::connect(how); }), what);
}

class Connect : public testing::Test {
 protected:
  test::RuntimeFolder folder;
};

TEST_F(Connect, SaysWhereItLookedWhenNoDaemonIsThere) {
  expect_refusal(options("r", "3"),
                 AllOf(HasSubstr(folder.path() + "/limb_ring/r/3.host"), HasSubstr("is ringd running")));
}

TEST_F(Connect, NamesTheNodesOfThisHostIfAskedForAnother) {
  test::FakeDaemon twelfth("r", "12"), third;
  const std::string in_ring = folder.path() + "/limb_ring/r/";
  ASSERT_EQ(symlink("3.host", (in_ring + "left_knee.host").c_str()), 0);
  ASSERT_EQ(symlink("4.host", (in_ring + "left_foot.host").c_str()), 0);
  EXPECT_EQ(nodes_here("r"), (std::vector<std::string>{"left_knee", "12"}));
  expect_refusal(options("r", "knee"),
                 AllOf(HasSubstr("is ringd running"), HasSubstr("; nodes of this ring here: left_knee, 12")));
  // That one is known, and not the one that was meant by mistake.
  expect_refusal(options("r", "left_foot"), testing::Not(HasSubstr("nodes of this ring")));
}

TEST_F(Connect, SaysThatNoRingIsRunning) { expect_refusal(options("", "3"), HasSubstr("no ring is running")); }

TEST_F(Connect, AsksForANode) { expect_refusal(options("r", ""), HasSubstr("LIMB_RING_NODE")); }

TEST_F(Connect, RefusesANameThatCouldLeaveTheFolder) {
  expect_refusal(options("../r", "3"), HasSubstr("ring '../r'"));
  expect_refusal(options("r", "../3"), HasSubstr("node '../3'"));
}

TEST_F(Connect, RefusesAPathTooLongForASocket) {
  setenv("XDG_RUNTIME_DIR", (folder.path() + "/" + std::string(90, 'd')).c_str(), 1);
  expect_refusal(options("r", "3"), AllOf(HasSubstr("107"), HasSubstr("shorter")));
}

TEST_F(Connect, RefusesAnotherUsersFolder) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can make another user's folder";
  test::FakeDaemon daemon;
  ASSERT_EQ(chown((folder.path() + "/limb_ring/r").c_str(), 65534, 65534), 0);
  expect_refusal(options("r", "3"), HasSubstr("another user's socket"));
}

TEST_F(Connect, TakesTheOnlyRunningRingAndTheNodeOfTheEnvironment) {
  test::FakeDaemon daemon("only", "3");
  setenv("LIMB_RING_NODE", "3", 1);
  auto port = std::async([] { return HostPort::connect(options("", "")); });
  daemon.accept();  // running_rings() looks whether somebody answers
  daemon.hang_up();
  daemon.welcome();
  EXPECT_EQ(port.get().name(), "left_knee");
}

TEST_F(Connect, TakesTheRingOfTheEnvironment) {
  test::FakeDaemon one("one"), two("two");
  setenv("LIMB_RING_RING", "two", 1);
  auto port = std::async([] { return HostPort::connect(options("", "3")); });
  two.welcome();
  EXPECT_EQ(port.get().id(), 3);
}

TEST_F(Connect, NamesTheRingsIfSeveralRun) {
  test::FakeDaemon one("one"), two("two");
  EXPECT_EQ(running_rings(), (std::vector<std::string>{"one", "two"}));
  expect_refusal(options("", "3"), HasSubstr("one, two"));
}

TEST_F(Connect, GivesTheDaemonsReasonWhenItIsRefused) {
  test::FakeDaemon daemon;
  auto port = std::async([] { return HostPort::connect(options("r", "3")); });
  daemon.accept();
  daemon.say(client::Refused{"node 3 has a CPU already"});
  EXPECT_THAT(test::thrown<HostPortError>([&] { port.get(); }), HasSubstr("has a CPU already"));
}

TEST_F(Connect, GoesOnTryingWhileTheDaemonIsNotThere) {
  ConnectOptions patient = options("r", "3");
  patient.timeout = seconds{60};
  auto port = std::async([&] { return HostPort::connect(patient); });
  test::FakeDaemon daemon;
  daemon.welcome();
  EXPECT_EQ(port.get().ring(), "r");
}

TEST_F(Connect, TriesAgainIfTheDaemonEndsBeforeItsAnswer) {
  ConnectOptions patient = options("r", "3");
  patient.timeout = seconds{60};
  test::FakeDaemon daemon;
  auto port = std::async([&] { return HostPort::connect(patient); });
  daemon.accept();
  daemon.hang_up();
  daemon.welcome();
  EXPECT_EQ(port.get().id(), 3);
}

TEST_F(Connect, GivesUpOnADaemonThatNeverAnswers) {
  test::FakeDaemon daemon;
  expect_refusal(options("r", "3"), HasSubstr("does not answer"));
}

}  // namespace
}  // namespace limb_ring
