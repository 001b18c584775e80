// Every order of faults in a small ring, and the words for one of them.
#include "study/exploration.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/trace.h"
#include "support/thrown.h"

namespace limb_ring::study {
namespace {

using testing::HasSubstr;

std::string in_words(const std::optional<Exploration::Found>& found) {
  return found ? to_text(found->choices) + ": " + found->violation.what() : "";
}

Exploration::Bounds bounds(unsigned faults, unsigned places = Exploration::kAllPlaces) {
  Exploration::Bounds bounds;
  bounds.faults = faults;
  bounds.places = places;
  return bounds;
}

struct Worlds : testing::TestWithParam<World> {};

TEST_P(Worlds, KeepEveryPromiseWithEachFaultAtEachPlace) {
  Exploration one(GetParam(), bounds(1));
  one.run([] {});
  EXPECT_EQ(in_words(one.found()), "");
  EXPECT_GT(one.runs(), 50u);
  EXPECT_GT(one.recognised(), 0u);
}

// The first places alone: all of them would take minutes.
TEST_P(Worlds, KeepEveryPromiseWithEachPairOfFaultsAtTheFirstPlaces) {
  Exploration two(GetParam(), bounds(2, 4));
  two.run([] {});
  EXPECT_EQ(in_words(two.found()), "");
}

INSTANTIATE_TEST_SUITE_P(Small, Worlds,
                         testing::Values(World{3, 2, true, false}, World{3, 2, false, false}, World{3, 2, true, true},
                                         World{3, 2, true, false, true}, World{3, 2, true, true, true}),
                         [](const auto& made) {
                           const World& world = made.param;
                           return std::string(world.paced ? "paced" : "unpaced") +
                                  (world.fold_back ? "FoldingBack" : "") + (world.broken ? "Broken" : "");
                         });

// 6 faults of the slice itself, and of each of 3 nodes a restart, a freeze, a cut and an INTP.
TEST(Exploration, RunsEachFaultAtEachPlaceOnce) {
  Exploration none(World{}, bounds(0)), one(World{}, bounds(1)), first_only(World{}, bounds(1, 1));
  for (Exploration* exploration : {&none, &one, &first_only}) exploration->run([] {});
  EXPECT_EQ(none.runs(), 1u);
  EXPECT_EQ(one.runs(), 1 + none.places() * (6u + 4 * 3));
  EXPECT_EQ(first_only.runs(), 1 + (6u + 4 * 3));
}

// What a line out of the last node does to that one is its state from the start.
TEST(Exploration, CutsNoLineThatIsCut) {
  World chain;
  chain.broken = true;
  Exploration first(chain, bounds(1, 1));
  first.run([] {});
  EXPECT_EQ(first.runs(), 1 + (6u + 4 * 3 - 1));
}

constexpr World kSmallest{2, 1, false, false};

TEST(Exploration, OfStatesThatItRecognisesIsShorterAndFindsTheSame) {
  Exploration::Bounds all_runs = bounds(2);
  all_runs.recognise = false;
  Exploration all(kSmallest, all_runs), shorter(kSmallest, bounds(2));
  for (Exploration* exploration : {&all, &shorter}) exploration->run([] {});
  EXPECT_EQ(in_words(all.found()), "");
  EXPECT_EQ(in_words(shorter.found()), "");
  EXPECT_EQ(all.recognised(), 0u);
  EXPECT_EQ(all.states(), 0u);
  EXPECT_LT(shorter.runs(), all.runs());
  EXPECT_GT(shorter.recognised(), shorter.runs() / 10);
  EXPECT_GT(shorter.states(), 0u);
}

TEST(Exploration, OfTwoThreadsRunsAsManyAsOfOne) {
  Exploration::Bounds two = bounds(1);
  two.threads = 2;
  Exploration exploration(World{}, two), alone(World{}, bounds(1));
  unsigned told = 0;
  exploration.run([&told] { ++told; });
  alone.run([] {});
  EXPECT_EQ(exploration.runs(), alone.runs());
  EXPECT_EQ(told, exploration.runs());
  EXPECT_EQ(in_words(exploration.found()), "");
}

TEST(KnownStates, AreMetByAnotherRunWithNoMoreFaultsToStrike) {
  KnownStates states;
  EXPECT_FALSE(states.meet(7, 1, 1));
  EXPECT_FALSE(states.meet(7, 1, 1)) << "by the same run";
  EXPECT_TRUE(states.meet(7, 2, 1));
  EXPECT_TRUE(states.meet(7, 3, 0));
  EXPECT_FALSE(states.meet(7, 4, 2)) << "the first run did not try that";
  EXPECT_TRUE(states.meet(7, 5, 2));
  EXPECT_FALSE(states.meet(8, 5, 0));
  EXPECT_EQ(states.count(), 2u);
}

// A ring alone: the same states have the same hash at another instant, and a packet more makes another one.
std::uint64_t hash_of(sim::VirtualRing& ring) {
  StateHash hash(ring.size(), ring.now());
  hash("ring", ring);
  return hash.value();
}

TEST(StateHash, IsOfTheStateAndNotOfTheHashing) {
  sim::VirtualRing one({}), same({}), other({});
  for (sim::VirtualRing* ring : {&one, &same, &other}) ring->join();
  const std::uint64_t before = hash_of(one);
  EXPECT_EQ(hash_of(one), before);
  EXPECT_EQ(hash_of(same), before);
  other.send(wire::NodeId{0}, wire::NodeId{1}, {1, 2, 3});
  EXPECT_NE(hash_of(other), before);
  one.run_for(std::chrono::microseconds(1));
  EXPECT_NE(hash_of(one), before);
}

std::uint64_t trace_of(const std::string& choices, bool looked_at = false) {
  ExploredRun run(World{}, choices_from(choices));
  KnownStates states;
  if (looked_at) run.recognise(states, 1, 1);
  sim::Trace trace(run.ring());
  run.run();
  return trace.hash();
}

// Archiving a node in whose relayed packet the output was lost once changed that packet.
TEST(ExploredRun, IsTheSameWhenItsStatesAreLookedAt) {
  for (unsigned place = 0; place < 30; ++place)
    for (const char* strike :
         {"lost", "end-damaged", "doubled", "late", "restart:0", "freeze:0", "freeze:1", "cut:2"}) {
      const std::string choice = std::to_string(place) + ":" + strike;
      EXPECT_EQ(trace_of(choice, true), trace_of(choice)) << choice;
    }
}

TEST(ExploredRun, IsTheSameEachTimeAndAnotherWithAnotherStrike) {
  const std::uint64_t once = trace_of("3:lost,9:restart:1");
  EXPECT_EQ(trace_of("3:lost,9:restart:1"), once);
  EXPECT_NE(trace_of("3:lost,9:restart:2"), once);
  EXPECT_NE(trace_of("3:late,9:restart:1"), once);
}

TEST(Choices, AreReadBackFromTheirWords) {
  for (const char* text : {"", "0:lost", "12:header-damaged,20:restart:1", "3:cut:2,4:doubled,700:interrupt:0"})
    EXPECT_EQ(to_text(choices_from(text)), text);
}

TEST(Choices, ThatAreWrongAreNamed) {
  const auto problem = [](const std::string& text) {
    return test::thrown<std::invalid_argument>([&] { choices_from(text); });
  };
  EXPECT_THAT(problem("x:lost"), HasSubstr("'x' is not a whole number from 0 to 999999, as in 12:lost"));
  EXPECT_THAT(problem("1:lost,2:losst"), HasSubstr("'losst' is not one of lost, header-damaged"));
  EXPECT_THAT(problem("1:restart"), HasSubstr("restart needs a node"));
  EXPECT_THAT(problem("1:lost:2"), HasSubstr("lost is of no node"));
  EXPECT_THAT(problem("99999999:lost"), HasSubstr("'99999999' is not a whole number from 0 to 999999"));
  EXPECT_THAT(problem("5:lost,3:late"), HasSubstr("'3:late': its place is not behind"));
  EXPECT_THAT(problem("5:lost,5:late"), HasSubstr("'5:late': its place is not behind"));
}

}  // namespace
}  // namespace limb_ring::study
