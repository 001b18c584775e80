// Recordings of a ring: saved, whatever one of them is; old saves go, and only those of the ring.
#include "recorder/save_ring.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "recorder/recorder_file.h"
#include "sim/virtual_ring.h"
#include "support/temporary_folder.h"

namespace limb_ring::recorder {
namespace {

namespace fs = std::filesystem;

TEST(OldSaves, goAndThoseOfAnotherRingWhoseNameBeginsAlikeStay) {
  const test::TemporaryFolder temporary;
  const std::string& folder = temporary.path();
  const std::string mine = "leg-2026-11-23_061508_123-crash", newer = "leg-2026-11-23_061600_000-break";
  const std::string others = "leg-8-2026-11-22_061508_123-crash", own = "leg-notes";
  for (const std::string& name : {mine, newer, others, own}) fs::create_directories(folder + '/' + name);
  remove_old_saves(folder, "leg-", 1);
  EXPECT_FALSE(fs::exists(folder + '/' + mine));
  for (const std::string& name : {newer, others, own}) EXPECT_TRUE(fs::exists(folder + '/' + name)) << name;
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
                                                   testing::HasSubstr("2.record: this is no recording")));
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
