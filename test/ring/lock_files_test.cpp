// What is known of daemons by the files in their ring's folder.
#include "ring/ring_files.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "io/node_notes.h"
#include "io/regular_file.h"
#include "limb_ring/ring_directory.h"
#include "node/host_server.h"
#include "ring/live_faults.h"
#include "ring/running_daemons.h"
#include "support/node_literal.h"
#include "support/own_folder.h"
#include "support/thrown.h"

namespace limb_ring::live {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class RingFolder : public test::OwnFolder {
 protected:
  /// As a daemon does: holds a node, with our pid in its file.
  host::NodeLock lock_of(std::uint8_t node) const { return {ring, "legs", node, "left_knee"}; }

  const std::string ring = make_ring_directory("legs");
};

TEST_F(RingFolder, AnUpThatStartsTheRingHoldsItsLock) {
  EXPECT_EQ(held_up_lock(ring), "");
  std::ofstream(ring + "/up-waist.lock") << 4711 << '\n';
  EXPECT_EQ(held_up_lock(ring), "") << "its holder is gone";
  const auto node = lock_of(7);
  EXPECT_EQ(held_up_lock(ring), "");
  const auto up = process::LockFile::take(ring + "/up-waist.lock");
  EXPECT_EQ(held_up_lock(ring), ring + "/up-waist.lock");
}

TEST_F(RingFolder, AFifoOrAFolderInTheirPlaceTellsNothingAndKeepsNobodyWaiting) {
  for (const char* name : {"3.lock", "3.fault", "3.killed", "up.lock"})
    ASSERT_EQ(::mkfifo((ring + '/' + name).c_str(), 0600), 0);
  ASSERT_EQ(::mkdir((ring + "/4.lock").c_str(), 0700), 0);
  for (const std::uint8_t node : {3, 4}) {
    EXPECT_FALSE(holder_of(ring, node).held);
    EXPECT_EQ(holder_of(ring, node).pid, -1);
  }
  EXPECT_FALSE(note_of(ring, 3_id));
  EXPECT_FALSE(was_killed(ring, 3_id, 4711));
  EXPECT_THAT(held_nodes(ring), IsEmpty());
  EXPECT_EQ(held_up_lock(ring), "");
  EXPECT_EQ(process::lock_holder(ring + "/3.lock"), "another process");
  EXPECT_THAT(unreadable_files(ring), SizeIs(5));
  EXPECT_THAT(unreadable_files(ring),
              Contains(ring + "/3.lock is a FIFO, not a regular file: it tells nothing; remove it"));
  EXPECT_THAT(unreadable_files(ring), Contains(HasSubstr("4.lock is a folder, not a regular file")));
}

TEST_F(RingFolder, AnythingButARegularFileIsNotLocked) {
  ASSERT_EQ(::mkfifo((ring + "/7.lock").c_str(), 0600), 0);
  EXPECT_THAT(test::thrown<std::runtime_error>([&] { lock_of(7); }),
              HasSubstr("7.lock is a FIFO, not a regular file: it cannot be locked; remove it"));
}

TEST_F(RingFolder, HeldNodesAreThoseWhoseHolderLives) {
  std::ofstream(ring + "/3.lock") << 4711 << '\n';
  const auto held = lock_of(7);
  const auto nodes = held_nodes(ring);
  ASSERT_THAT(nodes, SizeIs(1));
  EXPECT_EQ(nodes[0].pid, ::getpid());
}

// As it makes the file again that a cleaner of temporary files has removed: it is there before it is locked.
TEST_F(RingFolder, ADaemonThatListensLivesThoughItsLockFileIsNotLocked) {
  boost::asio::io_context io;
  const host::Listener listener(io, ring, 7, "left_knee");
  for (const bool is_there : {false, true}) {
    if (is_there) std::ofstream(ring + "/7.lock") << "";
    EXPECT_TRUE(holder_of(ring, 7).held);
    EXPECT_EQ(holder_of(ring, 7).pid, ::getpid());
    ASSERT_THAT(held_nodes(ring), SizeIs(1));
    EXPECT_EQ(held_nodes(ring)[0].node, 7);
  }
}

TEST_F(RingFolder, APidIsTakenOnlyFromItsLineAndOnlyOfTheRightProgram) {
  const auto held = lock_of(7);
  for (const char* text : {"10:16:33.123 info [legs/left_knee] up\n", "", "1\n", "99999999999\n"}) {
    std::ofstream(ring + "/7.lock") << text;
    EXPECT_EQ(held_nodes(ring)[0].pid, -1) << text;
    EXPECT_EQ(holder_of(ring, 7).pid, -1) << text;
  }
  std::ofstream(ring + "/7.lock") << ::getpid() << "\n/some/other/program";
  EXPECT_EQ(held_nodes(ring)[0].pid, -1);
  std::ofstream(ring + "/7.lock") << ::getpid() << '\n';
  EXPECT_EQ(held_nodes(ring)[0].pid, ::getpid());
}

TEST_F(RingFolder, APidInAContainerThatIsAnotherDaemonsHereIsNotTaken) {
  const auto held = lock_of(7);
  const std::string program = std::filesystem::read_symlink("/proc/self/exe");
  std::ofstream(ring + "/7.lock") << ::getpid() << '\n'
                                  << program << '\0' << "/" << '\0' << "--ring" << '\0' << "b" << '\0';
  EXPECT_TRUE(holder_of(ring, 7).held);
  EXPECT_EQ(holder_of(ring, 7).pid, -1);
  const RunningDaemons daemons("legs", {fault::NamedNode{"left_knee", "7", 7_id}});
  EXPECT_THAT(test::thrown<std::runtime_error>([&] { daemons.kill(7_id); }), HasSubstr("runs in a container"));
  EXPECT_FALSE(was_killed(ring, 7_id, -1));
}

TEST_F(RingFolder, AFolderWithALineEndInItsNameIsReadWhole) {
  const auto before = std::filesystem::current_path();
  std::filesystem::create_directory(ring + "/two\nlines");
  std::filesystem::current_path(ring + "/two\nlines");
  const auto held = lock_of(7);
  std::filesystem::current_path(before);
  EXPECT_EQ(holder_of(ring, 7).folder, ring + "/two\nlines");
  EXPECT_EQ(holder_of(ring, 7).pid, ::getpid());
}

TEST_F(RingFolder, ADaemonOfTheReleaseBeforeIsKnownByItsLines) {
  const auto held = lock_of(7);
  const std::string program = std::filesystem::read_symlink("/proc/self/exe");
  std::ofstream(ring + "/7.lock") << ::getpid() << '\n' << program << "\n/home/me\n--node\n7\n";
  const Holder holder = holder_of(ring, 7);
  EXPECT_EQ(holder.folder, "/home/me");
  EXPECT_THAT(holder.arguments, ElementsAre("--node", "7"));
  std::ofstream lock(ring + "/7.lock");
  lock << ::getpid() << '\n' << program << "\n/home/me\n";
  std::ifstream command("/proc/self/cmdline");
  std::string word;
  for (std::getline(command, word, '\0'); std::getline(command, word, '\0');) lock << word << '\n';
  lock.close();
  EXPECT_EQ(holder_of(ring, 7).pid, ::getpid()) << "with the arguments of this process";
}

TEST_F(RingFolder, ADaemonThatStartsGetsItsNodeWhileOthersAskWhoHoldsIt) {
  std::atomic<bool> done{false};
  std::thread others([&] {
    while (!done) holder_of(ring, 3);
  });
  for (int start = 0; start < 3000; ++start) EXPECT_NO_THROW(lock_of(3)) << "start " << start;
  done = true;
  others.join();
}

TEST_F(RingFolder, RingThatIsNotThereHoldsNothing) { EXPECT_THAT(held_nodes(ring_directory("nowhere")), IsEmpty()); }

TEST_F(RingFolder, WhatOthersCouldHavePutThereSaysNothing) {
  const auto held = lock_of(7);
  std::filesystem::create_directory_symlink(ring, rings_directory() + "/linked");
  EXPECT_THAT(held_rings(), ElementsAre("legs"));
  EXPECT_EQ(holder_of(rings_directory() + "/linked", 7).pid, -1);
  ::chmod(ring.c_str(), 0755);
  EXPECT_THAT(held_rings(), IsEmpty());
  EXPECT_THAT(known_nodes(ring), IsEmpty());
  EXPECT_EQ(holder_of(ring, 7).program, "");
}

TEST_F(RingFolder, ANoteSaysWhatWasDoneToANodeUntilItIsRemoved) {
  write_note(ring, 3_id, "kill left_knee");
  ASSERT_TRUE(note_of(ring, 3_id));
  EXPECT_EQ(note_of(ring, 3_id)->words, "kill left_knee");
  EXPECT_EQ(note_of(ring, 3_id)->name(), "kill");
  remove_note(ring, 3_id);
  EXPECT_FALSE(note_of(ring, 3_id));
}

class KilledNode : public RingFolder {
 protected:
  KilledNode() {
    std::ofstream(ring + "/3.lock") << 4711 << '\n';
    write_killed(ring, 3_id, 4711);
    write_note(ring, 3_id, "kill left_knee");
  }
};

TEST_F(KilledNode, IsOneWhoseLastDaemonWasKilledOnPurpose) {
  EXPECT_TRUE(is_killed(ring, 3_id));
  EXPECT_FALSE(is_killed(ring, 4_id));
  EXPECT_THAT(killed_rings(), ElementsAre("legs"));
}

TEST_F(KilledNode, IsNoLongerOneOnceAnotherDaemonHasStarted) {
  {
    const auto held = lock_of(3);
    EXPECT_FALSE(is_killed(ring, 3_id));
  }
  EXPECT_FALSE(is_killed(ring, 3_id)) << "it has ended, but was not killed";
  EXPECT_THAT(killed_rings(), IsEmpty());
}

TEST_F(KilledNode, IsListedUntilAnotherDaemonHasBegunAndLookingChangesNothing) {
  const LiveFaults faults("legs", {fault::NamedNode{"left_knee", "3", 3_id}});
  EXPECT_THAT(faults.list().faults, SizeIs(1));
  {
    const auto held = lock_of(3);
    EXPECT_THAT(faults.list().faults, IsEmpty());
  }
  EXPECT_THAT(faults.list().faults, IsEmpty());
  EXPECT_TRUE(note_of(ring, 3_id));
}

TEST_F(KilledNode, HasAClockOfItsMachineWhichNobodySetsOnPurpose) {
  const LiveFaults faults("legs", {fault::NamedNode{"left_knee", "3", 3_id}});
  fault::Fault fault;
  fault.name = fault::Name::step_clock;
  fault.nodes = {3_id};
  fault.back = std::chrono::seconds(1);
  EXPECT_THAT([&] { faults.begin(fault); },
              testing::Throws<NotDone>(
                  testing::Property(&NotDone::what, testing::HasSubstr("clocks are those of the machine"))));
}

TEST_F(KilledNode, OfARingThatGoesOnDoesNotMakeItDead) {
  const auto held = lock_of(7);
  EXPECT_THAT(killed_rings(), IsEmpty());
}

TEST_F(KilledNode, IsNotOneThatIsFrozen) {
  write_note(ring, 3_id, "freeze left_knee");
  EXPECT_FALSE(is_killed(ring, 3_id));
}

TEST_F(KilledNode, HasTheNameOfItsNoteAndOthersThatOfTheirSocketOrTheirId) {
  for (const char* id : {"12", "13", "14"}) std::ofstream(ring + '/' + id + ".lock") << 4712 << '\n';
  ASSERT_EQ(::symlink("13.host", (ring + "/left_hip.host").c_str()), 0);
  ASSERT_EQ(::symlink("14.host", (ring + "/left\nhip.host").c_str()), 0);
  ASSERT_EQ(::symlink("3.host", (ring + "/head.host").c_str()), 0);
  std::vector<std::string> names;
  for (const KnownNode& node : known_nodes(ring)) names.push_back(std::to_string(node.id) + ' ' + node.name);
  EXPECT_THAT(names, ElementsAre("3 left_knee", "12 12", "13 left_hip", "14 14"));
}

TEST_F(RingFolder, AFileThatIsNotANoteIsIgnored) {
  std::ofstream(ring + "/3.fault") << "nonsense\n";
  EXPECT_FALSE(note_of(ring, 3_id));
}

TEST_F(RingFolder, WhoWasKilledOnPurposeIsKnownAlsoWhenTheNextDaemonRuns) {
  EXPECT_FALSE(was_killed(ring, 3_id, 4711));
  EXPECT_EQ(write_killed(ring, 3_id, 4711), "");
  write_note(ring, 3_id, "kill left_knee");
  remove_note(ring, 3_id);  // 'fault start'
  EXPECT_TRUE(was_killed(ring, 3_id, 4711));
  EXPECT_FALSE(was_killed(ring, 3_id, 4712));
  EXPECT_FALSE(was_killed(ring, 4_id, 4711));
}

/// @return why `act` could not be done
template <typename Act>
std::string refusal(Act act) {
  try {
    act();
  } catch (const std::runtime_error& problem) {  // NotDone or HostPortError
    return problem.what();
  }
  return "it was done";
}

TEST_F(RingFolder, ADaemonThatDoesNotRunCannotBeKilledOrFrozen) {
  const RunningDaemons daemons("legs", {fault::NamedNode{"left_knee", "3", 3_id}});
  std::ofstream(ring + "/3.lock") << ::getpid() << '\n';  // nobody holds it: that pid is another's by now
  EXPECT_THAT(refusal([&] { daemons.kill(3_id); }),
              HasSubstr("node left_knee of ring legs has no daemon on this host"));
  EXPECT_THAT(refusal([&] { daemons.freeze(3_id); }), HasSubstr("has no daemon on this host"));
}

TEST_F(RingFolder, ADaemonThatNeverRanCannotBeStartedAgain) {
  const RunningDaemons daemons("legs", {fault::NamedNode{"left_knee", "3", 3_id}});
  EXPECT_THAT(refusal([&] { daemons.start(3_id); }), HasSubstr("has never run on this host"));
}

TEST_F(RingFolder, ADaemonThatRunsIsNotStartedAgain) {
  const RunningDaemons daemons("legs", {fault::NamedNode{"left_knee", "3", 3_id}});
  const auto held = lock_of(3);
  EXPECT_THAT(refusal([&] { daemons.start(3_id); }), HasSubstr("runs already, pid " + std::to_string(::getpid())));
}

}  // namespace
}  // namespace limb_ring::live
