// What is seen at the nodes of a sound ring breaks no promise, whatever happens to it.
#include <gtest/gtest.h>

#include "judge/judged_ring.h"
#include "study/random_faults.h"

namespace limb_ring::promises {
namespace {

using study::RandomFaults;

TEST(PromiseJudge, findsNothingInASoundRingUnderRandomFaults) {
  JudgeCounts all;
  for (std::uint64_t seed = 1; seed <= 25 && !HasFailure(); ++seed) {
    RandomFaults run(seed, RandomFaults::FoldBack::some,
                     seed % 3 == 0 ? RandomFaults::World::wide : RandomFaults::World::usual);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + run.describe());
    JudgedRing judged(run.ring());
    run.run();
    judged.finish();
    EXPECT_EQ(judged.first(), "");
    const JudgeCounts& counts = judged.judge().counts();
    all.sends += counts.sends;
    all.judged += counts.judged;
    all.packets += counts.packets;
    for (std::size_t i = 0; i < kUnjudged; ++i) all.unjudged[i] += counts.unjudged[i];
  }
  EXPECT_GT(all.judged, all.sends * 9 / 10) << describe(all);
  EXPECT_LT(all.all_unjudged(), (all.sends + all.packets) / 5) << describe(all);
}

}  // namespace
}  // namespace limb_ring::promises
