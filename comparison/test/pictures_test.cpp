// What the pictures of a comparison are drawn from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <sstream>

#include "comparison/plots/picture.h"

namespace limb_ring::comparison {
namespace {

using study::Comparison;
using study::ComparisonOptions;
using testing::HasSubstr;
using testing::Not;

struct Pictures : testing::Test {
  Comparison comparison;
  ComparisonOptions options;
  Pictures() {
    const study::Subject ring{"limb_ring", false, 1'000'000'000}, bus{"bus", false, 1'000'000'000};
    const study::Subject own{"limb_ring", true, 100'000'000};
    comparison.methods = {{ring, {}}, {bus, {}}, {own, {}}};
    comparison.methods[0].figures.efficiency = 0.5;
    comparison.against_load = {{ring, 0.5, 0.5}, {ring, 1, 0.9}, {bus, 0.5, 0.4}, {bus, 1, 0.41}, {own, 0.5, 0.1}};
    for (const study::Subject& subject : {ring, bus, own})
      for (const unsigned nodes : {4u, 16u})
        comparison.against_nodes.push_back({subject, nodes, {std::chrono::microseconds(nodes), {}}});
    options.seed = 42;
    options.loads = {0.5, 1};
    options.nodes = {4, 16};
  }
  PlotInput input() const { return {comparison, options}; }
};

TEST_F(Pictures, SayWhatTheyWereMadeWith) {
  EXPECT_EQ(figures_of(options), "N = 16, B = 512 bytes, R = 1000 Mbit/s, d = 0.512 us, seed 42");
  EXPECT_THAT(plot_efficiency(input()).script, HasSubstr(figures_of(options)));
  EXPECT_THAT(plot_latency_nodes(input()).script,
              HasSubstr("N = 4 to 16, B = 512 bytes, R = 1000 Mbit/s, d = 0.512 us, seed 42"));
}

// T + d = 4.704 us: 2 hops of 4 nodes, 8 of 16.
TEST_F(Pictures, LatencyAgainstNodesHasAColumnForEachMethodAndTheBound) {
  EXPECT_EQ(plot_latency_nodes(input()).csv,
            "nodes,limb_ring,bus,bound of limb_ring: N/2 (T + d)\n"
            "4,4.000000,4.000000,9.408000\n"
            "16,16.000000,16.000000,37.632000\n");
}

// At 100 Mbit/s T = 41.92 us.
TEST_F(Pictures, LatencyAtOwnRatesHasTheBoundAtOurs) {
  EXPECT_EQ(plot_latency_nodes_own_rates(input()).csv,
            "nodes,limb_ring at 100 Mbit/s,bound of limb_ring: N/2 (T + d)\n"
            "4,4.000000,84.864000\n"
            "16,16.000000,339.456000\n");
}

TEST_F(Pictures, EfficiencyShowsTheMethodsAtOneRate) {
  EXPECT_EQ(plot_efficiency(input()).csv,
            "offered_percent,limb_ring,bus\n"
            "50.000,50.000,40.000\n"
            "100.000,90.000,41.000\n");
}

/// One column of a picture's figures, from 0.
std::vector<double> column(const std::string& csv, unsigned number) {
  std::istringstream text(csv);
  std::vector<double> out;
  std::string line, cell;
  for (std::getline(text, line); std::getline(text, line);) {
    std::istringstream cells(line);
    for (unsigned i = 0; i <= number; ++i) std::getline(cells, cell, ',');
    out.push_back(std::stod(cell));
  }
  return out;
}

TEST_F(Pictures, RoundTripsSumUp) {
  const Picture picture = plot_round_trips(input());
  const auto packets = column(picture.csv, 2), percents = column(picture.csv, 3);
  const auto count = std::accumulate(packets.begin(), packets.end(), 0.0);
  EXPECT_THAT(picture.script, HasSubstr("Round trips of " + std::to_string(static_cast<int>(count)) + " packets"));
  EXPECT_NEAR(std::accumulate(percents.begin(), percents.end(), 0.0), 100, 0.001);
}

// 16 (T + d) = 75.264 us, which is a multiple of a bin's width up to 75 ps.
TEST_F(Pictures, RoundTripsAreDrawnBelowTheBound) {
  const Picture picture = plot_round_trips(input());
  EXPECT_THAT(picture.script, HasSubstr("bound = 75.264000\n"));
  EXPECT_THAT(picture.script, HasSubstr("random load of 47.5 % of R"));  // 0.95 * 0.5
  EXPECT_THAT(picture.csv, testing::StartsWith("from_us,to_us,packets,percent\n"));
  EXPECT_LE(column(picture.csv, 1).back(), 75.2641);
}

TEST_F(Pictures, EmbeddingHasBothBounds) {
  const Picture picture = plot_embedding(input());
  EXPECT_THAT(picture.script, HasSubstr("bound_embedded = 10.752000\n"));
  EXPECT_THAT(picture.script, HasSubstr("bound_between = 76.800000\n"));
  EXPECT_THAT(picture.csv, HasSubstr("\n0.0,8.288000,"));
}

// T = 4.192 us, d = 0.512 us: the row of node 1, where it waits for T in the worst case.
TEST_F(Pictures, TimelinesHaveARowForEachNode) {
  EXPECT_THAT(plot_timeline_alone(input()).csv, HasSubstr("\nours,1,0,1,0.512000,4.704000,0.512000,4.704000\n"));
  EXPECT_THAT(plot_timeline_alone(input()).csv, Not(HasSubstr("own")));
  const std::string worst = plot_timeline_worst(input()).csv;
  EXPECT_THAT(worst, HasSubstr("\nours,1,0,1,0.512000,4.704000,4.704000,8.896000\n"));
  EXPECT_THAT(worst, HasSubstr("\nown,1,1,0,,,0.512000,4.704000\n"));
  EXPECT_THAT(worst, HasSubstr("\nrelayed,2,1,1,1.024000,5.216000,1.024000,5.216000\n"));
  EXPECT_THAT(worst, HasSubstr("\nours,16,0,16,71.072000,75.264000,,\n"));
}

}  // namespace
}  // namespace limb_ring::comparison
