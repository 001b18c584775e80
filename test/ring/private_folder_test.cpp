#include "ring/launched_ring.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "limb_ring/ring_directory.h"

namespace limb_ring::live {
namespace {

TEST(PrivateFolder, HoldsTheRingsOfThisProcessWhileItIsThere) {
  ::setenv("XDG_RUNTIME_DIR", "/nobody/is/here", 1);
  {
    const PrivateFolder folder;
    EXPECT_EQ(rings_directory(), folder.path() + "/limb_ring");
  }
  EXPECT_EQ(rings_directory(), "/nobody/is/here/limb_ring");
}

TEST(PrivateFolder, HidesTheUsersRingAndNode) {
  ::setenv("LIMB_RING_RING", "robot", 1);
  {
    const PrivateFolder folder;
    EXPECT_EQ(std::getenv("LIMB_RING_RING"), nullptr);
  }
  EXPECT_STREQ(std::getenv("LIMB_RING_RING"), "robot");
}

TEST(PrivateFolder, IsRemovedWithAllThatIsInIt) {
  std::string path;
  {
    const PrivateFolder folder;
    path = folder.path();
    std::ofstream(path + "/left.log") << "something";
    ASSERT_TRUE(std::filesystem::exists(path + "/left.log"));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace limb_ring::live
