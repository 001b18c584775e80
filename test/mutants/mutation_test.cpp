// Each check of the ring's promises can fail: a core broken on purpose is caught by it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mutants/mutation.h"
#include "sim/virtual_line_faults.h"
#include "study/exploration.h"
#include "study/random_faults.h"

namespace limb_ring::study {
namespace {

using core::Mutation;
using sim::Promise;

struct Case {
  const char* name;
  Mutation mutation;
  Promise promise;
};

/// The first broken promise of some seeds; none if all were kept.
std::optional<sim::Violation> first_violation(Mutation mutation, Promise wanted, std::uint64_t seeds = 40) {
  core::mutation = mutation;
  std::optional<sim::Violation> found;
  for (std::uint64_t seed = 1; seed <= seeds && !(found && found->promise == wanted); ++seed) {
    RandomFaults run(seed);
    run.run();
    if (run.violation()) found = run.violation();
  }
  core::mutation = Mutation::none;
  return found;
}

struct Mutations : testing::TestWithParam<Case> {};

TEST_P(Mutations, AreCaughtByTheCheckOfTheirPromise) {
  const auto violation = first_violation(GetParam().mutation, GetParam().promise);
  ASSERT_TRUE(violation);
  EXPECT_EQ(violation->promise, GetParam().promise) << violation->what();
  EXPECT_NE(violation->what(), "");
}

INSTANTIATE_TEST_SUITE_P(
    Each, Mutations,
    testing::Values(Case{"ResultTwice", Mutation::result_twice, Promise::one_result},
                    Case{"SaysDelivered", Mutation::says_delivered, Promise::true_result},
                    Case{"TakesDamaged", Mutation::takes_damaged, Promise::undamaged},
                    Case{"ForgetsDuplicates", Mutation::forgets_duplicates, Promise::exactly_once},
                    Case{"RefusedGoesLast", Mutation::refused_goes_last, Promise::in_order},
                    Case{"HoldsInterrupts", Mutation::holds_interrupts, Promise::interrupt_wait},
                    Case{"PassesOrphans", Mutation::passes_orphans, Promise::no_circling},
                    Case{"LiesInFbc", Mutation::lies_in_fbc, Promise::true_fbc},
                    Case{"SendsLowestFirst", Mutation::sends_lowest_first, Promise::priority_first},
                    Case{"GivesLowestFirst", Mutation::gives_lowest_first, Promise::priority_first},
                    Case{"MissesBroadcasts", Mutation::misses_broadcasts, Promise::true_fbc},
                    Case{"RefusesEveryTenth", Mutation::refuses_every_tenth, Promise::true_fbc},
                    Case{"ShortRoundTrips", Mutation::short_round_trips, Promise::true_result},
                    Case{"CountsOneTry", Mutation::counts_one_try, Promise::true_result},
                    Case{"GivesUpAtBeacons", Mutation::gives_up_at_beacons, Promise::true_result},
                    Case{"RefusedAtOnce", Mutation::refused_at_once, Promise::true_result},
                    Case{"FullTooEarly", Mutation::full_too_early, Promise::true_result},
                    Case{"CancelsNothing", Mutation::cancels_nothing, Promise::true_result},
                    Case{"NeverHeals", Mutation::never_heals, Promise::whole_again}),
    [](const auto& made) { return made.param.name; });

struct ExploredCase {
  const char* name;
  Mutation mutation;
  World world;
  unsigned faults;
};

struct Explored : testing::TestWithParam<ExploredCase> {};

/// What the first run that breaks a promise breaks, with so many faults.
std::string first_broken(const ExploredCase& of, bool recognise) {
  core::mutation = of.mutation;
  Exploration::Bounds bounds;
  bounds.faults = of.faults;
  bounds.recognise = recognise;
  Exploration exploration(of.world, bounds);
  exploration.run([] {});
  core::mutation = Mutation::none;
  const auto& found = exploration.found();
  return found ? std::to_string(found->choices.size()) + ": " + to_string(found->violation.promise) : "none";
}

TEST_P(Explored, AreFoundByTryingEveryFaultAtEachPlace) {
  const std::string broken = first_broken(GetParam(), true);
  EXPECT_THAT(broken, testing::StartsWith(std::to_string(GetParam().faults) + ": "));
  EXPECT_EQ(broken, first_broken(GetParam(), false)) << "a state that was met before is recognised, or not";
}

constexpr World kThree{3, 2, true, false};
constexpr World kChain{3, 2, true, false, true};
INSTANTIATE_TEST_SUITE_P(Each, Explored,
                         testing::Values(ExploredCase{"ResultTwice", Mutation::result_twice, kThree, 0},
                                         ExploredCase{"ShortRoundTrips", Mutation::short_round_trips, kThree, 0},
                                         ExploredCase{"SaysDelivered", Mutation::says_delivered, kThree, 1},
                                         ExploredCase{"TakesDamaged", Mutation::takes_damaged, kThree, 1},
                                         ExploredCase{"ForgetsDuplicates", Mutation::forgets_duplicates, kThree, 1},
                                         ExploredCase{"PassesOrphans", Mutation::passes_orphans, kThree, 1},
                                         ExploredCase{"CountsOneTry", Mutation::counts_one_try, kThree, 1},
                                         ExploredCase{"NeverHeals", Mutation::never_heals, kThree, 1},
                                         ExploredCase{"TakesDamagedInAChain", Mutation::takes_damaged, kChain, 1},
                                         ExploredCase{"NeverHealsAChain", Mutation::never_heals, kChain, 0}),
                         [](const auto& made) { return made.param.name; });

/// All nodes always have large packets to send, on lines of 1 Gbit/s.
std::optional<sim::Violation> violation_of_a_full_ring(Mutation mutation) {
  core::mutation = mutation;
  sim::VirtualRingOptions options;
  options.nodes = 8;
  options.byte_time = std::chrono::nanoseconds(8);
  sim::VirtualRing ring(options);
  sim::Invariants invariants(ring);
  ring.join();
  for (unsigned node = 0; node < options.nodes; ++node)
    for (unsigned i = 0; i < 20; ++i)
      ring.send(static_cast<wire::NodeId>(node), static_cast<wire::NodeId>((node + 3) % options.nodes),
                std::vector<std::uint8_t>(512));
  ring.run_for(std::chrono::milliseconds(1));
  core::mutation = Mutation::none;
  return invariants.violation();
}

TEST(FullRing, KeepsItsInsertionBuffersWithinTheirBound) {
  EXPECT_FALSE(violation_of_a_full_ring(Mutation::none));
  const auto violation = violation_of_a_full_ring(Mutation::does_not_wait);
  ASSERT_TRUE(violation);
  EXPECT_EQ(violation->promise, Promise::insertion_bound) << violation->what();
}

/// A node sends over a line that harms one packet in so many, and nothing else is wrong: the hellos are long ago.
std::optional<sim::Violation> violation_on_a_bad_line(Mutation mutation, fault::Name harm, unsigned once_in) {
  core::mutation = mutation;
  sim::VirtualRingOptions options;
  options.nodes = 4;
  sim::VirtualRing ring(options);
  sim::Invariants invariants(ring);
  sim::VirtualLineFaults faults(ring, 1);
  faults.tap_all();
  ring.join();
  ring.run_for(std::chrono::seconds(2));
  fault::Fault bad;
  bad.name = harm;
  bad.nodes = {wire::NodeId{0}};
  bad.once_in = once_in;
  faults.begin(bad);
  for (unsigned i = 0; i < 20; ++i) {
    ring.send(wire::NodeId{0}, wire::NodeId{2}, std::vector<std::uint8_t>(64));
    ring.run_for(std::chrono::seconds(1));
  }
  core::mutation = Mutation::none;
  return invariants.violation();
}

TEST(BadLine, ShowsACoreThatDoesNotLookAtTheCrc) {
  EXPECT_FALSE(violation_on_a_bad_line(Mutation::none, fault::Name::corrupt, 3));
  const auto violation = violation_on_a_bad_line(Mutation::takes_damaged, fault::Name::corrupt, 3);
  ASSERT_TRUE(violation);
  EXPECT_EQ(violation->promise, Promise::undamaged) << violation->what();
}

// Among random faults a node has always said hello not long ago, and its loss is an excuse.
TEST(BadLine, ShowsACoreThatGivesUpEarly) {
  EXPECT_FALSE(violation_on_a_bad_line(Mutation::none, fault::Name::drop, 2));
  const auto violation = violation_on_a_bad_line(Mutation::gives_up_early, fault::Name::drop, 2);
  ASSERT_TRUE(violation);
  EXPECT_EQ(violation->promise, Promise::true_result) << violation->what();
}

TEST(Unbroken, TheSameSeedsBreakNoPromise) { EXPECT_FALSE(first_violation(Mutation::none, Promise::one_result, 10)); }

}  // namespace
}  // namespace limb_ring::study
