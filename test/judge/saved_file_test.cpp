// Files of flight recorders are kept while they are written and after their process has died. A changed file is
// refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>

#include "judge/flight_recorder.h"
#include "judge/replay.h"
#include "sim/virtual_ring.h"
#include "support/temporary_folder.h"
#include "support/thrown.h"
#include "wire/pcapng.h"

namespace limb_ring::recorder {
namespace {

namespace fs = std::filesystem;
using core::Time;
using testing::HasSubstr;
using wire::NodeId;
using namespace std::chrono_literals;

constexpr std::chrono::nanoseconds kAll = 1h;

/// How many lives do not do again what was recorded.
unsigned differences(ReplayedRing& ring) {
  while (ring.step(kAll) != nullptr) {
  }
  unsigned different = 0;
  for (const auto& life : ring.lives()) different += life->replay().difference() ? 1 : 0;
  return different;
}

class SavedFile : public testing::Test {
 protected:
  SavedFile() { fs::create_directory(folder_ / "saved"); }

  /// A ring of four whose nodes record into the folder. It lasts until the next one.
  sim::VirtualRing& recorded_ring(const std::string& name = "four") {
    files_.clear();
    ring_ = std::make_unique<sim::VirtualRing>(sim::VirtualRingOptions());
    sim::VirtualRing& ring = *ring_;
    for (const NodeId id : ring.order()) {
      Title title;
      title.ring = name;
      title.node = "node" + std::to_string(id);
      title.settings = ring.settings(id);
      files_.push_back(std::make_unique<RecorderFile>(recording_of(folder_, id), FlightRecorder::kLeast,
                                                      ring.controller(id), title, ring.now(), [] {}));
    }
    return ring;
  }
  static void exchange(sim::VirtualRing& ring) {
    for (std::uint8_t i = 0; i < 40; ++i) {
      ring.send(NodeId{static_cast<std::uint8_t>(i % 4)}, NodeId{static_cast<std::uint8_t>((i + 1) % 4)}, {i, 2, 3});
      ring.interrupt(NodeId{1}, NodeId{3}, 0);
      ring.run_for(core::Duration{1ms});
    }
  }
  void save_all() {
    for (const std::string& file : recordings_in(folder_)) save_file(file, saved(fs::path(file).filename()));
  }
  std::string saved(const std::string& name) const { return (folder_ / "saved" / name).string(); }
  static std::string why_refused(const std::string& folder) {
    try {
      ReplayedRing ring(folder);
    } catch (const std::runtime_error& problem) {
      return problem.what();
    }
    return "";
  }

  /// What was saved, replayed and written as pcapng.
  std::string captured() const {
    std::ostringstream file;
    ReplayedRing replayed((folder_ / "saved").string());
    ReplayCapture capture(replayed, file);
    EXPECT_EQ(differences(replayed), 0u);
    return file.str();
  }

  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::unique_ptr<sim::VirtualRing> ring_;  ///< goes after its recorders
  std::vector<std::unique_ptr<RecorderFile>> files_;
};

TEST_F(SavedFile, isReplayedInTheOrderOfTime) {
  sim::VirtualRing& ring = recorded_ring();
  ring.join();
  exchange(ring);
  save_all();
  ReplayedRing replayed((folder_ / "saved").string());
  ASSERT_EQ(replayed.lives().size(), 4u);
  std::chrono::nanoseconds last{0};
  std::uint64_t records = 0;
  while (ReplayedLife* life = replayed.step(kAll)) {
    const auto at = replayed.after(life->machine_time(life->replay().now()));
    EXPECT_GE(at, last);
    last = at;
    ++records;
  }
  EXPECT_GT(records, 1000u);
  EXPECT_EQ(differences(replayed), 0u);
  EXPECT_EQ(replayed.lives()[2]->replay().controller().counters().sent_data, ring.counters(NodeId{2}).sent_data);
}

TEST_F(SavedFile, stopsAtAnInstantAndTellsTheState) {
  sim::VirtualRing& ring = recorded_ring();
  ring.join();
  exchange(ring);
  save_all();
  ReplayedRing replayed((folder_ / "saved").string());
  while (replayed.step(1us) != nullptr) {
  }
  const std::string early = describe_state(replayed.lives()[1]->replay().controller());
  while (replayed.step(kAll) != nullptr) {
  }
  const std::string late = describe_state(replayed.lives()[1]->replay().controller());
  EXPECT_THAT(early, testing::Not(HasSubstr("ring_size 4")));
  EXPECT_THAT(late, HasSubstr("\nmembership.ring_size 4\n"));
}

TEST_F(SavedFile, isThereAfterItsProcessWasKilled) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    sim::VirtualRing& ring = recorded_ring();
    ring.join();
    exchange(ring);
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  save_all();
  ReplayedRing replayed((folder_ / "saved").string());
  EXPECT_EQ(differences(replayed), 0u);
  EXPECT_GT(replayed.lives()[0]->replay().records(), 300u);
}

TEST_F(SavedFile, keepsTheLifeBefore) {
  for (int life = 0; life < 3; ++life) {
    sim::VirtualRing& ring = recorded_ring();
    ring.join();
  }
  EXPECT_EQ(recordings_in(folder_).size(), 8u);
  save_all();
  ReplayedRing replayed((folder_ / "saved").string());
  EXPECT_EQ(replayed.lives().size(), 8u);
  EXPECT_EQ(differences(replayed), 0u);
}

TEST_F(SavedFile, withAnyByteChangedIsRefused) {
  sim::VirtualRing& ring = recorded_ring();
  ring.join();
  save_file(recording_of(folder_, 1), saved("1.record"));
  std::ifstream in(saved("1.record"), std::ios::binary);
  const std::string good((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  ASSERT_EQ(why_refused(folder_ / "saved"), "");
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    std::string bad = good;
    bad[random() % bad.size()] ^= static_cast<char>(1u << random() % 8);
    std::ofstream(saved("1.record"), std::ios::binary) << bad;
    EXPECT_THAT(why_refused(folder_ / "saved"), HasSubstr("1.record: it was changed since it was saved")) << i;
  }
  std::ofstream(saved("1.record"), std::ios::binary) << good.substr(0, good.size() / 2);
  EXPECT_THAT(why_refused(folder_ / "saved"), HasSubstr("cut off"));
  std::ofstream(saved("1.record"), std::ios::binary) << "";
  EXPECT_THAT(why_refused(folder_ / "saved"), HasSubstr("not a saved recording"));
}

TEST_F(SavedFile, ofAnotherFormSaysThatItIs) {
  recorded_ring();
  const std::string path = recording_of(folder_, 1);
  std::fstream(path, std::ios::binary | std::ios::in | std::ios::out).write("limbrec2", kMagic.size());
  EXPECT_THAT([&] { save_file(path, saved("1.record")); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("recorded by another version of limb_ring")));
}

TEST_F(SavedFile, becomesACaptureOfAllLines) {
  sim::VirtualRing& ring = recorded_ring();
  ring.join();
  ring.send(NodeId{0}, NodeId{2}, {7, 8, 9});
  ring.run_for(core::Duration{5ms});
  save_all();
  std::stringstream file(captured());
  capture::PcapngReader reader(file, "capture");
  unsigned seen = 0;
  while (const auto record = reader.next()) {
    const auto* packet = std::get_if<CapturedPacket>(&*record);
    const bool is_it = packet != nullptr && packet->bytes.size() == wire::kOverhead + 3 && packet->bytes[4] == 7;
    seen += is_it ? 1 : 0;
  }
  EXPECT_EQ(seen, 8u) << "out of and into each of four nodes";
}

// Node 1, which the packet only passes, has its CRC and not its data; source and destination have that.
TEST_F(SavedFile, saysInACaptureOfWhichPacketsTheDataIsNotThere) {
  sim::VirtualRing& ring = recorded_ring();
  ring.join();
  ring.send(NodeId{0}, NodeId{2}, std::vector<std::uint8_t>(100, 0x5A));
  ring.run_for(core::Duration{5ms});
  save_all();
  const std::string data(100, 0x5A);
  const std::string of_all = captured();
  EXPECT_THAT(of_all, testing::Not(HasSubstr("that was not recorded")));
  fs::remove(saved("0.record"));
  fs::remove(saved("2.record"));
  const std::string of_others = captured();
  EXPECT_THAT(of_others, HasSubstr("that was not recorded"));
  EXPECT_THAT(of_others, testing::Not(HasSubstr(data)));
}

TEST_F(SavedFile, ofAnotherRingIsRefusedBesideTheseOfOne) {
  recorded_ring("four");
  save_all();
  for (const std::string& file : recordings_in(folder_)) fs::remove(file);
  recorded_ring("other");
  save_file(recording_of(folder_, 1), saved("7.record"));
  EXPECT_THAT(why_refused(folder_ / "saved"), HasSubstr("7.record: is of ring other, and "));
}

TEST_F(SavedFile, isMadeOfARegularFile) {
  const std::string recording = recording_of(folder_, 9);
  ASSERT_EQ(::mkfifo(recording.c_str(), 0600), 0);
  EXPECT_THAT(test::thrown<std::runtime_error>([&] { save_file(recording, saved("9.record")); }),
              HasSubstr("9.record: it is a FIFO, not a regular file; remove it"));
}

TEST_F(SavedFile, isARegularFile) {
  fs::create_symlink("/dev/zero", saved("1.record"));
  EXPECT_THAT(why_refused(folder_ / "saved"), HasSubstr("1.record: is not a file"));
}

TEST_F(SavedFile, ofOtherContentIsInvalid) {
  EXPECT_THAT(why_refused(folder_ / "nothing"), HasSubstr("no recordings are there"));
  std::ofstream(folder_ / "9.record") << std::string(100000, 'x');
  EXPECT_THROW(save_file((folder_ / "9.record").string(), saved("9.record")), std::runtime_error);
}

TEST(FlightRecorder, whoseStateHasNoRoomSaysSo) {
  sim::VirtualRingOptions options;
  options.adjust = [](core::Settings& settings) { settings.send_queue = 65536; };
  sim::VirtualRing ring(options);
  ring.join();
  for (int i = 0; i < 1000; ++i) ring.send(NodeId{0}, NodeId{2}, std::vector<std::uint8_t>(500));
  std::vector<std::uint64_t> memory(FlightRecorder::kLeast / 8);
  Title title;
  title.settings = ring.settings(NodeId{0});
  bool told = false;
  FlightRecorder recorder(ring.controller(NodeId{0}), reinterpret_cast<std::uint8_t*>(memory.data()),
                          FlightRecorder::kLeast, title, ring.now(), [&told] { told = true; });
  EXPECT_TRUE(told);
  ring.run_for(core::Duration{1ms});  // nothing is written beyond the memory's end: the sanitizer looks
}

}  // namespace
}  // namespace limb_ring::recorder
