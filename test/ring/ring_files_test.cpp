#include "ring/ring_files.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "limb_ring/ring_directory.h"
#include "support/own_folder.h"

namespace limb_ring::live {
namespace {

class RingFiles : public test::OwnFolder {
 protected:
  void put(const std::string& name) const { std::ofstream(ring + '/' + name) << "mine"; }
  bool there(const std::string& name) const { return std::filesystem::exists(ring + '/' + name); }

  const std::string ring = make_ring_directory("legs");
};

TEST(NodeOfAFile, IsTheIdInItsName) {
  EXPECT_EQ(node_of("/run/limb_ring/legs/12.host", ".host"), 12);
  EXPECT_EQ(node_of("254.lock", ".lock"), 254);
  for (const char* none : {"12.lock", "255.host", "1000.host", "left_knee.host", ".host", "1a.host"})
    EXPECT_EQ(node_of(none, ".host"), std::nullopt) << none;
}

TEST_F(RingFiles, GoWithTheirFolder) {
  for (const char* name : {"3.host", "3.link", "3.link2", "3.watch", "3.lock", "up.lock", "up-waist.lock", "3.boot",
                           "3.record", "3.record.former", "3.record.new", "3.log", "ring.log", "keep.log", "3.fault",
                           "3.fault.4711", "3.killed", "3.killed.4711", "3.taken"})
    put(name);
  std::filesystem::create_symlink("3.host", ring + "/left_knee.host");
  remove_leftovers(ring);
  EXPECT_FALSE(std::filesystem::exists(ring));
}

TEST_F(RingFiles, OfOthersStay) {
  put("3.lock");
  put("notes.txt");
  put("notes.4711");
  remove_leftovers(ring);
  EXPECT_FALSE(there("3.lock"));
  EXPECT_TRUE(there("notes.txt"));
  EXPECT_TRUE(there("notes.4711"));
}

TEST_F(RingFiles, StayInAFolderThatIsOpenToOthers) {
  put("7.lock");
  ::chmod(ring.c_str(), 0755);
  EXPECT_THAT(files_in(ring), testing::IsEmpty());
  remove_leftovers(ring);
  EXPECT_TRUE(there("7.lock"));
}

}  // namespace
}  // namespace limb_ring::live
