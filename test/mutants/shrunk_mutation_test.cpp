// `ring_sim soak --shrink` on a core broken on purpose: what is left is small, fails each time, and not on a sound
// core.
#include <gtest/gtest.h>

#include <regex>

#include "mutants/mutation.h"
#include "sim/load_scenario.h"
#include "study/shrunk_soak.h"

namespace limb_ring::study {
namespace {

using core::Mutation;
using sim::Promise;

struct ShrunkCase {
  const char* name;
  Mutation mutation;
  Promise promise;
  std::uint64_t first_seed = 1;
};

struct ShrunkMutations : testing::TestWithParam<ShrunkCase> {
  ~ShrunkMutations() override { core::mutation = Mutation::none; }

  /// Of the first seeds that break the promise, until it is small, as `ring_sim soak --shrink` does it.
  static std::optional<scenario::Shrunk> shrunk() {
    std::optional<scenario::Shrunk> smaller;
    unsigned broken = 0;
    const std::uint64_t first = GetParam().first_seed;
    for (std::uint64_t seed = first; seed < first + 60 && broken < 6 && !(smaller && is_small(smaller->after));
         ++seed) {
      RandomFaults run(seed);
      run.keep_history();
      run.run();
      if (!run.violation() || run.violation()->promise != GetParam().promise) continue;
      ++broken;
      smaller = shrunk_soak(run, [](std::size_t) {});
    }
    return smaller;
  }
  static bool fails(const std::string& text) {
    const scenario::Scenario again = scenario::parse_scenario(text, "again.yaml");
    const auto run = run_scenario(again, again.seed);
    return run.unmet && run.unmet->expected == std::string("the ring's promise: ") + to_string(GetParam().promise);
  }
};

TEST_P(ShrunkMutations, AreLeftWithLittleThatFailsEachTimeAndNotOnASoundCore) {
  core::mutation = GetParam().mutation;
  const auto small = shrunk();
  ASSERT_TRUE(small);
  EXPECT_LE(small->after.faults, 3u) << small->text;
  EXPECT_LE(small->after.sends, 10u) << small->text;
  unsigned failed = 0;
  for (unsigned again = 0; again < 100; ++again) failed += fails(small->text) ? 1 : 0;
  EXPECT_EQ(failed, 100u) << small->text;
  core::mutation = Mutation::none;
  EXPECT_FALSE(fails(small->text)) << small->text;
  RecordProperty("tried", static_cast<int>(small->runs));
}

// Each mutation there is. A soak that begins at seed 1 does not see that a send is given up early for a long time.
INSTANTIATE_TEST_SUITE_P(
    Each, ShrunkMutations,
    testing::Values(ShrunkCase{"ResultTwice", Mutation::result_twice, Promise::one_result},
                    ShrunkCase{"SaysDelivered", Mutation::says_delivered, Promise::true_result},
                    ShrunkCase{"TakesDamaged", Mutation::takes_damaged, Promise::undamaged},
                    ShrunkCase{"ForgetsDuplicates", Mutation::forgets_duplicates, Promise::exactly_once},
                    ShrunkCase{"RefusedGoesLast", Mutation::refused_goes_last, Promise::in_order},
                    ShrunkCase{"HoldsInterrupts", Mutation::holds_interrupts, Promise::interrupt_wait},
                    ShrunkCase{"DoesNotWait", Mutation::does_not_wait, Promise::priority_first},
                    ShrunkCase{"PassesOrphans", Mutation::passes_orphans, Promise::no_circling},
                    ShrunkCase{"LiesInFbc", Mutation::lies_in_fbc, Promise::true_fbc},
                    ShrunkCase{"SendsLowestFirst", Mutation::sends_lowest_first, Promise::priority_first},
                    ShrunkCase{"GivesLowestFirst", Mutation::gives_lowest_first, Promise::priority_first},
                    ShrunkCase{"MissesBroadcasts", Mutation::misses_broadcasts, Promise::true_fbc},
                    ShrunkCase{"RefusesEveryTenth", Mutation::refuses_every_tenth, Promise::true_fbc},
                    ShrunkCase{"ShortRoundTrips", Mutation::short_round_trips, Promise::true_result},
                    ShrunkCase{"CountsOneTry", Mutation::counts_one_try, Promise::true_result},
                    ShrunkCase{"GivesUpEarly", Mutation::gives_up_early, Promise::true_result, 466},
                    ShrunkCase{"RefusedAtOnce", Mutation::refused_at_once, Promise::true_result},
                    ShrunkCase{"FullTooEarly", Mutation::full_too_early, Promise::true_result},
                    ShrunkCase{"CancelsNothing", Mutation::cancels_nothing, Promise::true_result},
                    ShrunkCase{"NeverHeals", Mutation::never_heals, Promise::whole_again}),
    [](const auto& made) { return std::string(made.param.name); });

/// As if its nodes were those of a ring's file: node 3 has the id 13, and is limb3.
void name_nodes(scenario::Scenario& scenario) {
  for (std::size_t place = 0; place < scenario.ring.nodes.size(); ++place) {
    scenario.ring.nodes[place].id = static_cast<std::uint8_t>(std::stoi("1" + std::to_string(place)));
    scenario.ring.nodes[place].name = "limb" + std::to_string(place);
  }
}

std::string with_names(const std::string& what) {
  return std::regex_replace(what, std::regex("node (\\d+)"), "node 1$1 (limb$1)");
}

// Before anything is left out, a scenario is what the seed was; its nodes have names.
TEST(ScenarioOfASeed, FailsAtTheVeryInstantAtWhichTheSeedDid) {
  core::mutation = Mutation::counts_one_try;
  unsigned failed = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    RandomFaults run(seed);
    run.keep_history();
    run.run();
    if (!run.violation()) continue;
    ++failed;
    scenario::Scenario again = scenario::parse_scenario(scenario_of(run), "again.yaml");
    name_nodes(again);
    const auto result = run_scenario(again, seed);
    ASSERT_TRUE(result.unmet) << "seed " << seed;
    EXPECT_EQ(result.unmet->seen, with_names(run.violation()->what())) << "seed " << seed;
    EXPECT_EQ(result.unmet->at,
              std::chrono::duration_cast<std::chrono::nanoseconds>(run.violation()->at.time_since_epoch()));
  }
  core::mutation = Mutation::none;
  EXPECT_GT(failed, 0u);
}

}  // namespace
}  // namespace limb_ring::study
