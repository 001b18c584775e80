// What a flight recorder has written down of a core is had again exactly, and what is changed in it is found.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "recorder/flight_recorder.h"
#include "recorder/replay.h"
#include "study/soak/random_faults.h"

namespace limb_ring::recorder {
namespace {

using core::NetworkController;
using core::Time;
using wire::NodeId;

/// A recorder and its memory.
struct Recorded {
  explicit Recorded(NetworkController& controller, Time now, std::size_t size = FlightRecorder::kLeast)
      : memory(size / 8) {
    Title title;
    title.settings = controller.settings();
    title.node = "node" + std::to_string(title.settings.id);
    recorder = std::make_unique<FlightRecorder>(controller, bytes(), size, title, now, [] {});
  }
  std::uint8_t* bytes() { return reinterpret_cast<std::uint8_t*>(memory.data()); }
  wire::ByteView view() { return {bytes(), memory.size() * 8}; }

  std::vector<std::uint64_t> memory;
  std::unique_ptr<FlightRecorder> recorder;
};

/// Replays all of it. @return the difference in words, empty where there is none
std::string replayed(wire::ByteView memory, std::uint64_t& records) {
  const std::vector<std::uint8_t> saved = save(memory);
  const Recording recording = read_saved({saved.data(), saved.size()});
  Replay replay(recording);
  while (replay.step()) {
  }
  records += replay.records();
  if (!replay.difference()) return "";
  const Difference& d = *replay.difference();
  return d.what + ": recorded " + d.recorded + ", replayed " + d.replayed;
}

/// Records every life of every node of a ring under random faults, and replays it when it is over.
class AllLives : public sim::Observer {
 public:
  explicit AllLives(sim::VirtualRing& ring) : ring_(ring), lives_(ring.size()) {
    for (const NodeId id : ring.order()) begin(id);
    ring.add_observer(*this);
  }
  void end_all() {
    for (const NodeId id : ring_.order()) end(id);
    EXPECT_GT(records, 1000u);
  }
  void incident(NodeId id, sim::Incident incident, Time, core::Line) override {
    if (incident == sim::Incident::killed) end(id);
    if (incident == sim::Incident::started) begin(id);
  }

  std::uint64_t records = 0, lives = 0, halves = 0;

 private:
  void begin(NodeId id) { lives_[id] = std::make_unique<Recorded>(ring_.controller(id), ring_.now()); }
  void end(NodeId id) {
    if (lives_[id] == nullptr) return;
    ++lives;
    const std::vector<std::uint8_t> saved = save(lives_[id]->view());
    halves += read_saved({saved.data(), saved.size()}).halves.back().generation;
    EXPECT_EQ(replayed(lives_[id]->view(), records), "") << "node " << int{id};
    lives_[id].reset();
  }

  sim::VirtualRing& ring_;
  std::vector<std::unique_ptr<Recorded>> lives_;
};

TEST(Replay, whatRandomFaultsHaveDoneToNodesIsHadAgain) {
  std::uint64_t halves = 0, lives = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    study::RandomFaults run(seed, study::RandomFaults::FoldBack::some,
                            seed % 2 == 0 ? study::RandomFaults::World::wide : study::RandomFaults::World::usual);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + run.describe());
    AllLives recorded(run.ring());
    run.run();
    recorded.end_all();
    halves += recorded.halves;
    lives += recorded.lives;
    if (HasFailure()) break;
  }
  EXPECT_GT(lives, 300u);
  EXPECT_GT(halves, 10 * lives) << "states in the middle of a life were gone on from, too";
}

}  // namespace
}  // namespace limb_ring::recorder
