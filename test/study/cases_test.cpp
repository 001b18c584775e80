// The cases of protocol.md section 7.2, as ring_sim shows them.
#include "study/cases.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "sim/trace.h"

namespace limb_ring::study {
namespace {

using namespace std::chrono_literals;

Medium of(unsigned nodes, unsigned payload = 512) {
  Medium medium;
  medium.nodes = nodes;
  medium.payload = payload;
  return medium;
}

Duration worst(Case which, const Medium& medium, std::uint64_t seed = 1) {
  return run_case(which, medium, seed).measured.max();
}

TEST(Cases, GiveThePapersFigures) {
  EXPECT_EQ(worst(Case::alone, of(16)), 12384ns);
  EXPECT_EQ(worst(Case::simultaneous, of(16)), 67584ns);
  EXPECT_EQ(worst(Case::adversarial, of(16)), 75264ns);
  EXPECT_EQ(worst(Case::request, of(16)), 79456ns - Duration{1});
  EXPECT_EQ(worst(Case::delivery, of(16)), 15 * 4704ns);
  EXPECT_EQ(worst(Case::interrupt, of(16)), 9728ns);
  EXPECT_NEAR(run_case(Case::saturated, of(16), 1).measured_share, 16 * 4.192 / (16 * 4.192 + 0.512), 1e-9);
  EXPECT_NEAR(run_case(Case::payload, of(16), 1).measured_share, 512.0 / 524, 1e-12);
}

TEST(Cases, TellThatTheyGoOn) {
  unsigned told = 0;
  CaseRecords records;
  records.goes_on = [&told] { ++told; };
  run_case(Case::saturated, of(16), 1, records);
  EXPECT_GT(told, 1u);
}

// With long packets beside the delay, INTPs hold DATPs up for longer than two worst laps, which have one INTP a node.
TEST(Cases, RepeatNothingHoweverLongInterruptsHoldItUp) {
  Medium medium = of(16);
  medium.relay_delay = Duration{0};
  const CaseRing ring(medium, nullptr);
  const core::Settings& settings = ring.settings(wire::NodeId{0});
  EXPECT_GT(settings.send_timeout(), 1000 * settings.worst_lap());
}

struct Sizes : testing::TestWithParam<std::tuple<unsigned, unsigned>> {
  Medium medium() const { return of(std::get<0>(GetParam()), std::get<1>(GetParam())); }
};

TEST_P(Sizes, ExactFormulasAreMetExactly) {
  for (const Case which : {Case::alone, Case::simultaneous, Case::adversarial, Case::delivery, Case::interrupt}) {
    const CaseResult result = run_case(which, medium(), 1);
    EXPECT_EQ(result.measured.max(), result.formula) << to_string(which);
  }
}

TEST_P(Sizes, BoundsAreNotExceeded) {
  for (const Case which : {Case::request, Case::interrupt_bound, Case::random}) {
    const CaseResult result = run_case(which, medium(), 3);
    EXPECT_LE(result.measured.max(), result.formula) << to_string(which);
    EXPECT_GT(result.measured.count(), 0u) << to_string(which);
  }
}

INSTANTIATE_TEST_SUITE_P(Some, Sizes,
                         testing::Combine(testing::Values(2u, 5u, 16u, 33u), testing::Values(4u, 64u, 512u)));

TEST(Cases, RandomPhasesFillTheLinesAsSectionSevenSays) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const double occupancy = run_case(Case::random, of(16), seed).occupancy;
    EXPECT_GT(occupancy, 0.975) << seed;
    EXPECT_LT(occupancy, 0.9925) << seed;
  }
}

TEST(Cases, SlowerLinesScale) {
  Medium medium = of(4);
  medium.rate = 1'000'000;
  EXPECT_EQ(worst(Case::adversarial, medium), 4 * (524 * 8us + 512ns));
}

TEST(Cases, OfTheSameSeedHaveTheSameTrace) {
  std::ostringstream first, second, other;
  const auto hash = run_case(Case::random, of(4), 7, {&first}).trace_hash;
  EXPECT_EQ(run_case(Case::random, of(4), 7, {&second}).trace_hash, hash);
  EXPECT_NE(run_case(Case::random, of(4), 8, {&other}).trace_hash, hash);
  EXPECT_EQ(first.str(), second.str());
  EXPECT_NE(first.str(), other.str());
}

}  // namespace
}  // namespace limb_ring::study
