// `ring_sim cause` on a core broken on purpose: the events that it names are those that the planted fault needs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "mutants/mutation.h"
#include "sim/load_scenario.h"
#include "study/shrunk_soak.h"

namespace limb_ring::study {
namespace {

using core::Mutation;
using sim::Promise;

struct CauseCase {
  const char* name;
  Mutation mutation;
  Promise promise;
  const char* planted;  ///< one of the needed events has these words
  std::uint64_t first_seed = 1;
  WorldKind world = WorldKind::usual;
};

struct Causes : testing::TestWithParam<CauseCase> {
  ~Causes() override { core::mutation = Mutation::none; }
};

/// The words of the needed events, a line each.
std::string needed_words(const scenario::Cause& cause, const scenario::Story& story) {
  std::string words;
  for (const auto& needed : cause.needed) words += story.words(needed.event) + "\n";
  return words;
}

/// The next seed from there on that breaks the promise; null: none of 60 does.
std::unique_ptr<RandomFaults> broken_run(std::uint64_t first, WorldKind world, Promise promise) {
  for (std::uint64_t seed = first; seed < first + 60; ++seed) {
    auto run = std::make_unique<RandomFaults>(seed, FoldingRings::some, world);
    run->keep_history();
    run->run();
    if (run->violation() && run->violation()->promise == promise) return run;
  }
  return nullptr;
}

TEST_P(Causes, AreThePlantedOnes) {
  core::mutation = GetParam().mutation;
  for (std::uint64_t seed = GetParam().first_seed;; ++seed) {
    const auto run = broken_run(seed, GetParam().world, GetParam().promise);
    ASSERT_NE(run, nullptr);
    seed = run->origin().seed;
    const auto story = story_of(*run);
    if (!story) continue;
    const scenario::Cause cause = scenario::cause_of(*story, [](std::size_t) {});
    SCOPED_TRACE("seed " + std::to_string(seed) + "\n" + text_of(cause, *story));
    EXPECT_THAT(needed_words(cause, *story), testing::ContainsRegex(GetParam().planted));
    std::vector<std::size_t> events;
    for (const auto& needed : cause.needed) events.push_back(needed.event);
    EXPECT_TRUE(story->fails(events));
    core::mutation = Mutation::none;
    EXPECT_FALSE(story->fails(events)) << "a sound core fails, too";
    std::cout << text_of(cause, *story);
    return;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Each, Causes,
    testing::Values(
        CauseCase{"ResultTwice", Mutation::result_twice, Promise::one_result, "send"},
        CauseCase{"SaysDelivered", Mutation::says_delivered, Promise::true_result, "kill|freeze|cut|power|damaged"},
        CauseCase{"TakesDamaged", Mutation::takes_damaged, Promise::undamaged, "damaged"},
        CauseCase{"ForgetsDuplicates", Mutation::forgets_duplicates, Promise::exactly_once,
                  "lost|damaged|delay|stall|duplicate|cut|mend"},
        CauseCase{"RefusedGoesLast", Mutation::refused_goes_last, Promise::in_order, "not_reading"},
        CauseCase{"HoldsInterrupts", Mutation::holds_interrupts, Promise::interrupt_wait, "interrupt"},
        CauseCase{"DoesNotWait", Mutation::does_not_wait, Promise::priority_first, "send"},
        CauseCase{"PassesOrphans", Mutation::passes_orphans, Promise::no_circling,
                  "kill|freeze|power_cycle|cut|damaged.*byte: [23]"},
        CauseCase{"LiesInFbc", Mutation::lies_in_fbc, Promise::true_fbc, "send"},
        CauseCase{"SendsLowestFirst", Mutation::sends_lowest_first, Promise::priority_first, "priority"},
        CauseCase{"GivesLowestFirst", Mutation::gives_lowest_first, Promise::priority_first, "not_reading|priority"},
        CauseCase{"MissesBroadcasts", Mutation::misses_broadcasts, Promise::true_fbc, "to: all"},
        CauseCase{"RefusesEveryTenth", Mutation::refuses_every_tenth, Promise::true_fbc, "send"},
        CauseCase{"ShortRoundTrips", Mutation::short_round_trips, Promise::true_result, "send"},
        CauseCase{"CountsOneTry", Mutation::counts_one_try, Promise::true_result,
                  "lost|damaged|not_reading|stall|delay|cut"},
        CauseCase{"GivesUpEarly", Mutation::gives_up_early, Promise::true_result, "lost|damaged|stall|delay", 466},
        CauseCase{"RefusedAtOnce", Mutation::refused_at_once, Promise::true_result, "send"},
        CauseCase{"FullTooEarly", Mutation::full_too_early, Promise::true_result, "send"},
        CauseCase{"CancelsNothing", Mutation::cancels_nothing, Promise::true_result, "cancel|reset"},
        CauseCase{"NeverHeals", Mutation::never_heals, Promise::whole_again, "cut|kill|freeze|power|lost"}),
    [](const auto& made) { return std::string(made.param.name); });

INSTANTIATE_TEST_SUITE_P(
    InOtherWorlds, Causes,
    testing::Values(CauseCase{"TakesDamagedWide", Mutation::takes_damaged, Promise::undamaged, "damaged", 1,
                              WorldKind::wide},
                    CauseCase{"ForgetsDuplicatesParts", Mutation::forgets_duplicates, Promise::exactly_once,
                              "lost|damaged|delay|stall|cut|mend|freeze|hosts", 1, WorldKind::parts},
                    CauseCase{"SaysDeliveredStorms", Mutation::says_delivered, Promise::true_result,
                              "kill|freeze|cut|power|damaged|hosts", 1, WorldKind::storms}),
    [](const auto& made) { return std::string(made.param.name); });

struct Replays : testing::TestWithParam<WorldKind> {
  ~Replays() override { core::mutation = Mutation::none; }
};

// Before anything is left out, the same is done once more, so that it fails in the same picosecond.
TEST_P(Replays, FailAtTheVeryInstantAtWhichTheSeedDid) {
  core::mutation = Mutation::counts_one_try;
  unsigned failed = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    RandomFaults run(seed, FoldingRings::some, GetParam());
    run.keep_history();
    run.run();
    if (!run.violation()) continue;
    ++failed;
    RandomFaults again(run.origin());
    again.replay(run, run.history(), run.acted_until(), true);
    ASSERT_TRUE(again.violation()) << "seed " << seed;
    EXPECT_EQ(again.violation()->what(), run.violation()->what()) << "seed " << seed;
    EXPECT_EQ(again.violation()->at, run.violation()->at) << "seed " << seed;
  }
  EXPECT_GT(failed, 0u);
}

INSTANTIATE_TEST_SUITE_P(Each, Replays,
                         testing::Values(WorldKind::usual, WorldKind::wide, WorldKind::parts, WorldKind::storms),
                         [](const auto& made) {
                           return std::string(kWorldNames[static_cast<std::size_t>(made.param)]);
                         });

struct Seals : testing::Test {
  ~Seals() override { core::mutation = Mutation::none; }
};

/// It needs one damaged slice, and no other event of the whole story does the same.
std::optional<std::size_t> only_damaged(const scenario::Cause& cause, const scenario::Story& story) {
  std::optional<std::size_t> damaged;
  for (const auto& needed : cause.needed) {
    if (!needed.alone_heals) return std::nullopt;
    if (story.words(needed.event).find("damaged") != std::string::npos) damaged = needed.event;
  }
  return damaged;
}

// If a node takes what is damaged, it is certain as soon as the slice is hit, and not before. If all is mended then,
// the slice has been hit all the same.
TEST_F(Seals, TheDamagedSliceItselfMakesItCertain) {
  core::mutation = Mutation::takes_damaged;
  for (const WorldKind world : {WorldKind::usual, WorldKind::wide, WorldKind::parts, WorldKind::storms}) {
    unsigned stories = 0;
    for (std::uint64_t seed = 1; stories < 2; ++seed) {
      const auto run = broken_run(seed, world, Promise::undamaged);
      ASSERT_NE(run, nullptr);
      seed = run->origin().seed;
      const auto story = story_of(*run);
      ASSERT_NE(story, nullptr);
      const scenario::Cause cause = scenario::cause_of(*story, [](std::size_t) {});
      const auto damaged = only_damaged(cause, *story);
      if (!damaged) continue;
      ++stories;
      EXPECT_EQ(cause.sealed_by, damaged) << "seed " << seed << "\n" << text_of(cause, *story);
    }
  }
}

TEST_F(Seals, TheDamagedSliceItselfMakesAScenarioCertain) {
  core::mutation = Mutation::takes_damaged;
  const auto run = broken_run(1, WorldKind::usual, Promise::undamaged);
  ASSERT_NE(run, nullptr);
  const auto story = scenario::story_of(scenario::parse_scenario(scenario_of(*run), "told.yaml"), run->origin().seed);
  ASSERT_NE(story, nullptr);
  const scenario::Cause cause = scenario::cause_of(*story, [](std::size_t) {});
  EXPECT_TRUE(only_damaged(cause, *story));
  EXPECT_EQ(cause.sealed_by, only_damaged(cause, *story)) << text_of(cause, *story);
}

}  // namespace
}  // namespace limb_ring::study
