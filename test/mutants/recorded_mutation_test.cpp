// Only a broken core can replay its own recording: a sound core does something else, and the other way round.
#include <gtest/gtest.h>

#include "judge/recorded_lives.h"
#include "mutants/mutation.h"
#include "study/random_faults.h"

namespace limb_ring::recorder {
namespace {

using core::Mutation;

struct RecordedMutations : testing::TestWithParam<Mutation> {
  ~RecordedMutations() override { core::mutation = Mutation::none; }

  static std::vector<std::vector<std::uint8_t>> record(std::uint64_t seed, Mutation mutation) {
    core::mutation = mutation;
    study::RandomFaults run(seed);
    RecordedLives lives(run.ring());
    run.run();
    return lives.end_all();
  }
  static unsigned differences(const std::vector<std::vector<std::uint8_t>>& lives, Mutation mutation) {
    core::mutation = mutation;
    unsigned count = 0;
    for (const auto& saved : lives) count += replayed(saved) ? 1 : 0;
    return count;
  }
};

TEST_P(RecordedMutations, areTheRecordedCoresOwn) {
  unsigned of_broken = 0, of_sound = 0;
  for (std::uint64_t seed = 1; seed <= 6 && (of_broken == 0 || of_sound == 0); ++seed) {
    const auto broken = record(seed, GetParam());
    ASSERT_EQ(differences(broken, GetParam()), 0u) << "seed " << seed;
    of_broken += differences(broken, Mutation::none);
    of_sound += differences(record(seed, Mutation::none), GetParam());
  }
  EXPECT_GT(of_broken, 0u) << "a sound core does what the broken one did";
  EXPECT_GT(of_sound, 0u) << "the broken core does what a sound one did";
}

// Those that show soon: a recording holds the last of a run, when all is mended again.
INSTANTIATE_TEST_SUITE_P(Each, RecordedMutations,
                         testing::Values(Mutation::result_twice, Mutation::forgets_duplicates,
                                         Mutation::short_round_trips, Mutation::counts_one_try));

}  // namespace
}  // namespace limb_ring::recorder
