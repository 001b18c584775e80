// Every order of faults in a small ring, and the words for one of them.
#include "study/explore/exploration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/trace.h"
#include "support/thrown.h"

namespace limb_ring::study {
namespace {

using testing::HasSubstr;

std::string in_words(const std::optional<Exploration::Found>& found) {
  return found ? to_text(found->choices) + ": " + found->violation.what : "";
}

struct Worlds : testing::TestWithParam<World> {};

TEST_P(Worlds, KeepEveryPromiseWithEachFaultAtEachPlace) {
  Exploration one(GetParam(), 1);
  one.run([] {});
  EXPECT_EQ(in_words(one.found()), "");
  EXPECT_GT(one.runs(), 100u);
}

// The first places alone: all of them would take minutes.
TEST_P(Worlds, KeepEveryPromiseWithEachPairOfFaultsAtTheFirstPlaces) {
  Exploration two(GetParam(), 2, 4);
  two.run([] {});
  EXPECT_EQ(in_words(two.found()), "");
}

INSTANTIATE_TEST_SUITE_P(Small, Worlds,
                         testing::Values(World{3, 2, true, false}, World{3, 2, false, false}, World{3, 2, true, true}),
                         [](const auto& world) {
                           return std::string(world.param.paced ? "paced" : "unpaced") +
                                  (world.param.fold_back ? "FoldingBack" : "");
                         });

// 6 faults of the slice itself, and of each of 3 nodes a restart, a freeze, a cut and an INTP.
TEST(Exploration, RunsEachFaultAtEachPlaceOnce) {
  Exploration none(World{}, 0), one(World{}, 1), first_only(World{}, 1, 1);
  for (Exploration* exploration : {&none, &one, &first_only}) exploration->run([] {});
  EXPECT_EQ(none.runs(), 1u);
  EXPECT_EQ(one.runs(), 1 + none.places() * (6u + 4 * 3));
  EXPECT_EQ(first_only.runs(), 1 + (6u + 4 * 3));
}

std::uint64_t trace_of(const std::string& choices) {
  ExploredRun run(World{}, choices_from(choices));
  sim::Trace trace(run.ring());
  run.run();
  return trace.hash();
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
  EXPECT_THAT(problem("x:lost"), HasSubstr("'x' is no number"));
  EXPECT_THAT(problem("1:lost,2:losst"), HasSubstr("'losst' is none of lost, header-damaged"));
  EXPECT_THAT(problem("1:restart"), HasSubstr("restart needs a node"));
  EXPECT_THAT(problem("1:lost:2"), HasSubstr("lost is of no node"));
  EXPECT_THAT(problem("99999999:lost"), HasSubstr("is no number"));
}

}  // namespace
}  // namespace limb_ring::study
