// Observations in mapped memory: all arrive, or the number of lost ones is told.
#include <gtest/gtest.h>

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <system_error>

#include "judge/observation_file.h"

namespace limb_ring::promises {
namespace {

struct ObservationFileTest : testing::Test {
  ObservationFileTest()
      : path((std::filesystem::temp_directory_path() / ("seen" + std::to_string(::getpid()))).string()) {}
  void write(std::uint32_t count) {
    Observation one;
    for (std::uint32_t i = 0; i < count; ++i) {
      one.token = next++;
      file.put(one);
    }
  }
  std::string path;
  ObservationFile file{path};
  std::uint32_t next = 0;
  std::vector<Observation> seen;
};

TEST_F(ObservationFileTest, aReaderGetsAllFromWhereItBegan) {
  write(10);
  ObservationReader reader(path, file.count());
  EXPECT_EQ(reader.read(seen), 0u);
  EXPECT_TRUE(seen.empty());
  write(3);
  EXPECT_EQ(reader.read(seen), 0u);
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(seen.front().token, 10u);
}

TEST_F(ObservationFileTest, aReaderThatIsTooSlowIsToldHowManyAreLost) {
  ObservationReader reader(path, 0);
  write(100000);
  const std::uint64_t lost = reader.read(seen);
  EXPECT_GT(lost, 0u);
  EXPECT_EQ(lost + seen.size(), 100000u);
  EXPECT_EQ(seen.back().token, 99999u);
  EXPECT_EQ(seen.front().token, lost);
}

TEST_F(ObservationFileTest, thatWasRemovedIsMadeAgainWithAllThatItHad) {
  ObservationReader before(path, file.count());
  write(10);
  ASSERT_TRUE(std::filesystem::remove(path));
  EXPECT_FALSE(file.is_there());
  file.make_again();
  EXPECT_TRUE(file.is_there());
  write(3);
  before.follow(path, file.count());
  EXPECT_EQ(before.read(seen), 0u);
  ASSERT_EQ(seen.size(), 13u);
  EXPECT_EQ(seen.front().token, 0u);
  EXPECT_EQ(seen.back().token, 12u);
}

TEST_F(ObservationFileTest, thatWasCutOffIsMadeAgainAndAReaderIsToldWhatIsLost) {
  ObservationReader before(path, file.count());
  write(10);
  std::filesystem::resize_file(path, 0);
  EXPECT_FALSE(file.is_there());
  write(3);
  EXPECT_EQ(before.read(seen), 0u);
  EXPECT_TRUE(seen.empty());
  file.make_again();
  EXPECT_TRUE(file.is_there());
  before.follow(path, file.count());
  write(2);
  EXPECT_EQ(before.read(seen), 13u);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen.front().token, 13u);
}

TEST_F(ObservationFileTest, thatFindsNoRoomLeavesNothing) {
  const std::string full = path + "full";
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit little{1000, before.rlim_max};
  const auto usual = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &little), 0);
  EXPECT_THROW(ObservationFile{full}, std::system_error);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, usual);
  EXPECT_FALSE(std::filesystem::exists(full));
}

TEST_F(ObservationFileTest, anotherFileIsRefused) {
  EXPECT_THROW(ObservationReader("/proc/self/stat", 0), std::exception);
  EXPECT_THROW(ObservationReader(path + "none", 0), std::exception);
}

}  // namespace
}  // namespace limb_ring::promises
