// What is known of daemons by the files in their ring's folder.
#include "live/lock_files.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>

#include "limb_ring/ring_directory.h"
#include "live/node_notes.h"
#include "live/running_daemons.h"
#include "process/unique_fd.h"
#include "support/own_folder.h"

namespace limb_ring::live {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// As a daemon does: holds DIRECTORY/ID.lock, with its pid in it.
class HeldLock {
 public:
  HeldLock(const std::string& path, pid_t pid) {
    std::ofstream(path) << pid << '\n';
    file_.reset(::open(path.c_str(), O_RDWR | O_CLOEXEC));
    ::flock(file_.get(), LOCK_EX | LOCK_NB);
  }

 private:
  process::UniqueFd file_;
};

class RingFolder : public test::OwnFolder {
 protected:
  const std::string ring = make_ring_directory("legs");
};

TEST_F(RingFolder, HeldNodesAreThoseWhoseHolderLives) {
  std::ofstream(ring + "/3.lock") << 4711 << '\n';
  const HeldLock held(ring + "/7.lock", 12);
  const auto nodes = held_nodes(ring);
  ASSERT_THAT(nodes, SizeIs(1));
  EXPECT_EQ(nodes[0].pid, 12);
}

TEST_F(RingFolder, LeftoversGoWithTheirFolder) {
  for (const char* name : {"3.boot", "3.lock", "3.host", "3.link", "3.log"}) std::ofstream(ring + "/" + name);
  std::filesystem::create_symlink("3.host", ring + "/left_knee.host");
  remove_leftovers(ring);
  EXPECT_FALSE(std::filesystem::exists(ring));
}

TEST_F(RingFolder, LeftoversOfOthersStay) {
  std::ofstream(ring + "/notes.txt") << "mine";
  remove_leftovers(ring);
  EXPECT_TRUE(std::filesystem::exists(ring + "/notes.txt"));
}

TEST_F(RingFolder, RingThatIsNotThereHoldsNothing) { EXPECT_THAT(held_nodes(ring_directory("nowhere")), IsEmpty()); }

TEST_F(RingFolder, ANoteSaysWhatWasDoneToANodeUntilItIsRemoved) {
  EXPECT_FALSE(is_killed(ring, 3));
  write_note(ring, 3, "kill left_knee");
  ASSERT_TRUE(note_of(ring, 3));
  EXPECT_EQ(note_of(ring, 3)->words, "kill left_knee");
  EXPECT_EQ(note_of(ring, 3)->name(), "kill");
  EXPECT_TRUE(is_killed(ring, 3));
  EXPECT_FALSE(is_killed(ring, 4));
  remove_note(ring, 3);
  EXPECT_FALSE(note_of(ring, 3));
}

TEST_F(RingFolder, ANodeThatIsFrozenWasNotKilled) {
  write_note(ring, 3, "freeze left_knee");
  EXPECT_FALSE(is_killed(ring, 3));
}

TEST_F(RingFolder, AFileThatIsNoNoteIsNone) {
  std::ofstream(ring + "/3.fault") << "nonsense\n";
  EXPECT_FALSE(note_of(ring, 3));
}

/// @return why `act` could not be done
template <typename Act>
std::string refusal(Act act) {
  try {
    act();
  } catch (const NotDone& problem) {
    return problem.what();
  }
  return "it was done";
}

TEST_F(RingFolder, ADaemonThatDoesNotRunCannotBeKilledOrFrozen) {
  const RunningDaemons daemons("legs", {fault::NamedNode{"left_knee", "3", 3}});
  std::ofstream(ring + "/3.lock") << ::getpid() << '\n';  // nobody holds it: that pid is another's by now
  EXPECT_THAT(refusal([&] { daemons.kill(3); }), HasSubstr("node left_knee of ring legs has no daemon on this host"));
  EXPECT_THAT(refusal([&] { daemons.freeze(3); }), HasSubstr("has no daemon on this host"));
}

TEST_F(RingFolder, ADaemonThatNeverRanCannotBeStartedAgain) {
  const RunningDaemons daemons("legs", {fault::NamedNode{"left_knee", "3", 3}});
  EXPECT_THAT(refusal([&] { daemons.start(3); }), HasSubstr("has never run on this host"));
}

TEST_F(RingFolder, ADaemonThatRunsIsNotStartedAgain) {
  const RunningDaemons daemons("legs", {fault::NamedNode{"left_knee", "3", 3}});
  const HeldLock held(ring + "/3.lock", 12);
  EXPECT_THAT(refusal([&] { daemons.start(3); }), HasSubstr("runs already, pid 12"));
}

}  // namespace
}  // namespace limb_ring::live
