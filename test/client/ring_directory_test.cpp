#include "limb_ring/ring_directory.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "support/runtime_folder.h"
#include "support/thrown.h"

namespace limb_ring {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class RingDirectory : public testing::Test {
 protected:
  test::RuntimeFolder folder;
};

TEST_F(RingDirectory, LiesInTheRuntimeFolder) {
  EXPECT_EQ(ring_directory("left-arm_2.b"), folder.path() + "/limb_ring/left-arm_2.b");
}

TEST_F(RingDirectory, OtherwiseLiesInItsOwnFolderBelowTheTemporaryOne) {
  unsetenv("XDG_RUNTIME_DIR");
  const fs::path expected = fs::temp_directory_path() / ("limb_ring-" + std::to_string(geteuid())) / "r";
  EXPECT_EQ(ring_directory("r"), expected.string());
  for (const char* relative : {"", ".", "run", "./run"}) {
    setenv("XDG_RUNTIME_DIR", relative, 1);
    EXPECT_EQ(ring_directory("r"), expected.string()) << relative;
  }
}

TEST_F(RingDirectory, RefusesInvalidNames) {
  for (const char* bad : {"", "..", ".hidden", "-o", "a/b", "a b", "\xC3\xA4", "a23456789012345678901234567890123"}) {
    EXPECT_THROW(ring_directory(bad), std::invalid_argument) << bad;
  }
  EXPECT_NO_THROW(ring_directory("a2345678901234567890123456789012"));
}

TEST_F(RingDirectory, RefusesANameInOneLineWhateverItContains) {
  EXPECT_THAT(test::thrown<std::invalid_argument>([] { ring_directory(std::string("a\0b\nc", 5)); }),
              AllOf(HasSubstr("ring 'a?b?c': a name has"), HasSubstr("begin with")));
}

TEST_F(RingDirectory, IsMadeForItsOwnerOnly) {
  const std::string made = make_ring_directory("r");
  struct stat status {};
  ASSERT_EQ(stat(made.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0700u);
  EXPECT_EQ(make_ring_directory("r"), made);
}

TEST_F(RingDirectory, IsRefusedIfItIsOpenToOthers) {
  const std::string made = make_ring_directory("r");
  chmod(made.c_str(), 0750);
  EXPECT_THAT(test::thrown<std::runtime_error>([] { make_ring_directory("r"); }),
              AllOf(HasSubstr(made), HasSubstr("chmod 700")));
}

TEST_F(RingDirectory, IsRefusedIfItIsALink) {
  make_ring_directory("r");
  fs::create_directory_symlink("r", rings_directory() + "/s");
  EXPECT_THAT(test::thrown<std::runtime_error>([] { make_ring_directory("s"); }), HasSubstr("symbolic link"));
}

TEST_F(RingDirectory, IsRefusedIfItBelongsToAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can make another user's folder";
  const std::string made = make_ring_directory("r");
  ASSERT_EQ(chown(made.c_str(), 65534, 65534), 0);
  EXPECT_THAT(test::thrown<std::runtime_error>([] { make_ring_directory("r"); }), HasSubstr("belongs to user 65534"));
}

TEST_F(RingDirectory, NamesTheRuntimeFolderThatIsMissing) {
  setenv("XDG_RUNTIME_DIR", (folder.path() + "/none").c_str(), 1);
  EXPECT_THAT(test::thrown<std::runtime_error>([] { make_ring_directory("r"); }),
              HasSubstr(folder.path() + "/none/limb_ring"));
}

TEST_F(RingDirectory, HoldsNoRunningRingIfNobodyListens) {
  EXPECT_TRUE(running_rings().empty());
  make_ring_directory("r");
  EXPECT_TRUE(running_rings().empty());
}

TEST(SocketPath, IsRefusedIfItIsTooLongForASocket) {
  const std::string longest = "/" + std::string(107 - 1 - std::string("/0.host").size(), 'd');
  EXPECT_EQ(socket_path(longest, "0", "host").size(), 107u);
  EXPECT_THAT(test::thrown<std::invalid_argument>([&] { socket_path(longest + "d", "0", "host"); }),
              AllOf(HasSubstr("108 bytes"), HasSubstr("107")));
}

TEST(SocketPath, IsRefusedForAnInvalidNodeName) {
  EXPECT_THROW(socket_path("/d", "../x", "host"), std::invalid_argument);
  EXPECT_THROW(socket_path("/d", "", "host"), std::invalid_argument);
}

}  // namespace
}  // namespace limb_ring
