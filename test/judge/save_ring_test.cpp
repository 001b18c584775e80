// Recordings of a ring are saved, even if one of them is bad. Old saves are deleted, but only those of this ring.
#include "judge/recording.h"

#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "judge/flight_recorder.h"
#include "sim/virtual_ring.h"
#include "support/temporary_folder.h"

namespace limb_ring::recorder {
namespace {

namespace fs = std::filesystem;

class OldSaves : public testing::Test {
 protected:
  /// A folder that was written so many hours ago.
  void make(const std::string& name, int hours_ago) const {
    fs::create_directories(path(name));
    fs::last_write_time(path(name), fs::file_time_type::clock::now() - std::chrono::hours(hours_ago));
  }
  std::string path(const std::string& name) const { return temporary_.path() + '/' + name; }
  std::set<std::string> left() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(temporary_.path())) names.insert(entry.path().filename().string());
    return names;
  }

 private:
  const test::TemporaryFolder temporary_;
};

TEST_F(OldSaves, goAndThoseOfAnotherRingWhoseNameBeginsAlikeStay) {
  const std::string mine = "leg-2026-11-23_061508_123-crash", newer = "leg-2026-11-23_061600_000-break";
  const std::string others = "leg-8-2026-11-22_061508_123-crash", own = "leg-notes";
  make(mine, 2);
  make(others, 3);
  make(own, 4);
  make(newer, 0);
  remove_old_saves(path(newer), "leg-", 1);
  EXPECT_EQ(left(), (std::set<std::string>{newer, others, own}));
}

TEST_F(OldSaves, goByTheirAgeThoughLocalTimeHasRunTwiceThroughAnHour) {
  const std::string summer = "leg-2026-10-25_025500_000-crash", winter = "leg-2026-10-25_020500_000-crash";
  const std::string newest = "leg-2026-10-25_021500_000-crash";
  make(summer, 2);
  make(winter, 1);
  make(newest, 0);
  remove_old_saves(path(newest), "leg-", 2);
  EXPECT_EQ(left(), (std::set<std::string>{winter, newest}));
}

TEST_F(OldSaves, goBeforeTheNewOnesThoughTheClockWasSetBackBehindThem) {
  const std::string future = "leg-2030-01-01_000001_000-crash", before = "leg-2026-11-23_061508_123-crash";
  const std::string newest = "leg-2026-11-23_061600_000-crash";
  make(future, -1000);
  make(before, 1);
  make(newest, 0);
  remove_old_saves(path(newest), "leg-", 2);
  EXPECT_EQ(left(), (std::set<std::string>{before, newest}));
}

TEST_F(OldSaves, neverGoIfTheyHaveJustBeenMade) {
  make("leg-2030-01-01_000001_000-crash", 0);
  make("leg-2026-11-23_061508_123-crash", 1000);
  remove_old_saves(path("leg-2026-11-23_061508_123-crash"), "leg-", 1);
  EXPECT_EQ(left(), std::set<std::string>{"leg-2026-11-23_061508_123-crash"});
}

TEST(Save, ofARingGoesOnBehindARecordingThatIsNone) {
  const test::TemporaryFolder temporary;
  const std::string from = temporary.path() + "/ring", to = temporary.path() + "/saved";
  fs::create_directories(from);
  std::ofstream(recording_of(from, 1));
  std::ofstream(recording_of(from, 2)) << "no recording";
  sim::VirtualRing ring{sim::VirtualRingOptions{}};
  Title title;
  title.settings = ring.settings(wire::NodeId{3});
  const RecorderFile recorder(recording_of(from, 3), FlightRecorder::kLeast, ring.controller(wire::NodeId{3}), title,
                              ring.now(), [] {});
  const SavedRing saved = save_ring(from, to);
  EXPECT_EQ(saved.recordings, 1u);
  EXPECT_TRUE(fs::exists(recording_of(to, 3)));
  EXPECT_THAT(saved.problems, testing::ElementsAre(testing::HasSubstr("1.record is empty"),
                                                   testing::HasSubstr("2.record: this is not a recording")));
}

TEST(Recorder, thatFindsNoRoomLeavesTheRecordingsOfFormerLives) {
  const test::TemporaryFolder temporary;
  const std::string path = recording_of(temporary.path(), 3);
  std::ofstream(path) << "last";
  std::ofstream(path + ".former") << "before";
  sim::VirtualRing ring{sim::VirtualRingOptions{}};
  Title title;
  title.settings = ring.settings(wire::NodeId{3});
  const auto make = [&](std::size_t size) {
    return RecorderFile(path, size, ring.controller(wire::NodeId{3}), title, ring.now(), [] {});
  };
  EXPECT_THROW(make(std::size_t{1} << 60), std::system_error);
  const auto text = [](const std::string& file) {
    std::ifstream in(file);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_EQ(text(path), "last");
  EXPECT_EQ(text(path + ".former"), "before");
  EXPECT_THAT(recordings_in(temporary.path()), testing::ElementsAre(path, path + ".former"));
  const RecorderFile recorder = make(FlightRecorder::kLeast);
  EXPECT_EQ(text(path + ".former"), "last");
}

}  // namespace
}  // namespace limb_ring::recorder
