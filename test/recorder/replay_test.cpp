// What a flight recorder has written down of a core is had again exactly.
#include <gtest/gtest.h>

#include "recorder/recorded_lives.h"
#include "study/soak/random_faults.h"

namespace limb_ring::recorder {
namespace {

TEST(Replay, whatRandomFaultsHaveDoneToNodesIsHadAgain) {
  std::uint64_t halves = 0, lives = 0;
  for (std::uint64_t seed = 1; seed <= 30 && !HasFailure(); ++seed) {
    study::RandomFaults run(seed, study::RandomFaults::FoldBack::some,
                            seed % 2 == 0 ? study::RandomFaults::World::wide : study::RandomFaults::World::usual);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + run.describe());
    RecordedLives recorded(run.ring());
    run.run();
    for (const std::vector<std::uint8_t>& saved : recorded.end_all()) {
      EXPECT_EQ(in_words(replayed(saved)), "");
      halves += read_saved({saved.data(), saved.size()}).halves.back().generation;
      ++lives;
    }
  }
  EXPECT_GT(lives, 300u);
  EXPECT_GT(halves, 10 * lives) << "states in the middle of a life were gone on from, too";
}

}  // namespace
}  // namespace limb_ring::recorder
