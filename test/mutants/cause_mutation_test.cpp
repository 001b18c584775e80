// `ring_sim cause` on a core broken on purpose: the events that it names are those that the planted fault needs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mutants/mutation.h"
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

TEST_P(Causes, AreThePlantedOnes) {
  core::mutation = GetParam().mutation;
  for (std::uint64_t seed = GetParam().first_seed;; ++seed) {
    ASSERT_LT(seed, GetParam().first_seed + 60);
    RandomFaults run(seed);
    run.keep_history();
    run.run();
    if (!run.violation() || run.violation()->promise != GetParam().promise) continue;
    const auto story = story_of(run, seed, FoldingRings::some);
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

}  // namespace
}  // namespace limb_ring::study
