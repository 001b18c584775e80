// A core broken on purpose parts from the specification's model.
#include <gtest/gtest.h>

#include "model/compared_ring.h"
#include "mutants/mutation.h"
#include "study/random_faults.h"

namespace limb_ring::model {
namespace {

using core::Mutation;

struct ModelMutations : testing::TestWithParam<Mutation> {
  ~ModelMutations() override { core::mutation = Mutation::none; }
};

/// Rings of a few nodes: they are compared in no time.
std::optional<Difference> first_difference(std::uint64_t seeds, study::RandomFaults::FoldBack fold_back) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    study::RandomFaults run(seed, fold_back);
    if (run.nodes() > 8) continue;
    ComparedRing compared(run.ring());
    run.run();
    if (const auto difference = compared.difference()) return difference;
  }
  return std::nullopt;
}

TEST_P(ModelMutations, PartFromTheModel) {
  core::mutation = GetParam();
  const auto difference = first_difference(200, study::RandomFaults::FoldBack::some);
  ASSERT_TRUE(difference);
  EXPECT_NE(difference->specified, difference->core) << in_words(*difference);
}

struct FoldMutations : ModelMutations {};

TEST_P(FoldMutations, PartFromTheModelOnRingsThatFoldBack) {
  core::mutation = GetParam();
  const auto difference = first_difference(200, study::RandomFaults::FoldBack::all);
  ASSERT_TRUE(difference);
  EXPECT_NE(difference->specified, difference->core) << in_words(*difference);
}

TEST(SoundCore, DoesNotPartFromTheModel) {
  for (const auto fold_back : {study::RandomFaults::FoldBack::some, study::RandomFaults::FoldBack::all}) {
    const auto difference = first_difference(40, fold_back);
    EXPECT_FALSE(difference) << in_words(*difference);
  }
}

INSTANTIATE_TEST_SUITE_P(Each, FoldMutations,
                         testing::Values(Mutation::repeats_unasked, Mutation::forgets_last, Mutation::hides_deafness,
                                         Mutation::takes_at_once));

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
