// A core broken on purpose parts from the specification's model.
#include <gtest/gtest.h>

#include "model/compared_ring.h"
#include "mutants/mutation.h"
#include "study/soak/random_faults.h"

namespace limb_ring::model {
namespace {

using core::Mutation;

struct ModelMutations : testing::TestWithParam<Mutation> {
  ~ModelMutations() override { core::mutation = Mutation::none; }
};

/// Rings without a fold, of a few nodes: they are compared in no time.
std::optional<Difference> first_difference(std::uint64_t seeds) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    study::RandomFaults run(seed);
    if (!comparable(run.ring()) || run.nodes() > 8) continue;
    ComparedRing compared(run.ring());
    run.run();
    if (const auto difference = compared.difference()) return difference;
  }
  return std::nullopt;
}

TEST_P(ModelMutations, PartFromTheModel) {
  core::mutation = GetParam();
  const auto difference = first_difference(200);
  ASSERT_TRUE(difference);
  EXPECT_NE(difference->specified, difference->core) << in_words(*difference);
}

TEST(SoundCore, DoesNotPartFromTheModel) {
  const auto difference = first_difference(40);
  EXPECT_FALSE(difference) << in_words(*difference);
}

INSTANTIATE_TEST_SUITE_P(Each, ModelMutations,
                         testing::Values(Mutation::result_twice, Mutation::says_delivered, Mutation::takes_damaged,
                                         Mutation::forgets_duplicates, Mutation::refused_goes_last,
                                         Mutation::holds_interrupts, Mutation::does_not_wait, Mutation::passes_orphans,
                                         Mutation::lies_in_fbc, Mutation::sends_lowest_first,
                                         Mutation::gives_lowest_first, Mutation::misses_broadcasts,
                                         Mutation::refuses_every_tenth, Mutation::short_round_trips,
                                         Mutation::counts_one_try, Mutation::gives_up_early, Mutation::refused_at_once,
                                         Mutation::full_too_early, Mutation::cancels_nothing, Mutation::never_heals));

}  // namespace
}  // namespace limb_ring::model
