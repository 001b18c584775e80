#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>

#include "comparison/command_line.h"
#include "comparison/pictures.h"
#include "comparison/plots.h"
#include "support/own_folder.h"
#include "support/thrown.h"
#include "tools/completed_help.h"
#include "tools/ring_sim/command_line.h"
#include "tools/run_cli.h"

namespace limb_ring::comparison {

/// A fresh folder for each test, removed at its end; PATH is put back too.
class PlotTest : public test::OwnFolder {
 protected:
  PlotTest() {
    if (const char* path = ::getenv("PATH")) path_ = path;
  }
  ~PlotTest() override { ::setenv("PATH", path_.c_str(), 1); }

  static bool gnuplot_missing() {
    return !test::thrown<std::runtime_error>([] { find_gnuplot(); }).empty();
  }

  static std::string read(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }

 private:
  std::string path_;
};

/// At the start of a test that draws.
#define LIMB_RING_NEEDS_GNUPLOT() \
  if (gnuplot_missing()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)"

// gnuplot as a child: what it draws, and every way in which it does not.

namespace {

using testing::HasSubstr;
using Gnuplot = PlotTest;

const Picture kLine{"line", "x,y\n1,1\n2,3\n", "set title 'a line'\nplot 'line.csv' using 1:2 with lines\n"};

TEST_F(Gnuplot, DrawsIntoAFolderOfAnyName) {
  LIMB_RING_NEEDS_GNUPLOT();
  const std::string odd = folder + "/new/it's \"odd\"; $HOME `x`";
  PlotFolder(odd).draw(kLine);
  for (const char* file : {"line.csv", "line.gp", "line.png", "line.svg"})
    EXPECT_TRUE(std::filesystem::exists(odd + "/" + file)) << file;
}

TEST_F(Gnuplot, ScriptThatItRefusesIsAnErrorWithItsMessage) {
  LIMB_RING_NEEDS_GNUPLOT();
  const auto draw = [this] { PlotFolder(folder).draw({"line", "", "nonsense\n"}); };
  EXPECT_THAT(test::thrown<std::runtime_error>(draw), HasSubstr("invalid command"));
}

TEST_F(Gnuplot, ScriptThatNeverEndsIsEnded) {
  LIMB_RING_NEEDS_GNUPLOT();
  std::ofstream(folder + "/long.gp") << "while (1) {}\n";
  const auto run = [this] { run_gnuplot(find_gnuplot(), folder, "long.gp", std::chrono::milliseconds(50)); };
  EXPECT_THAT(test::thrown<std::runtime_error>(run), HasSubstr("no end after 50 ms"));
}

TEST_F(Gnuplot, FileThatCannotBeWrittenIsAUsageError) {
  LIMB_RING_NEEDS_GNUPLOT();
  std::filesystem::create_directory(folder + "/line.gp");
  const auto draw = [this] { PlotFolder(folder).draw(kLine); };
  EXPECT_THAT(test::thrown<ring_sim::UsageError>(draw),
              HasSubstr(folder + "/line.gp: cannot be written: Is a directory"));
}

TEST_F(Gnuplot, IfItIsMissingTheErrorNamesThePackage) {
  ::setenv("PATH", "", 1);
  EXPECT_THAT(test::thrown<std::runtime_error>([] { find_gnuplot(); }), HasSubstr("install the package gnuplot-nox"));
}

TEST_F(Gnuplot, ProgramThatCannotBeStartedIsAnError) {
  std::ofstream(folder + "/gnuplot") << "no program";
  const auto run = [this] { run_gnuplot(folder + "/gnuplot", folder, "x.gp", std::chrono::seconds(10)); };
  EXPECT_THAT(test::thrown<std::runtime_error>(run), HasSubstr("gnuplot failed on " + folder + "/x.gp"));
}

}  // namespace

// What the pictures of a comparison are drawn from.

namespace {

using study::Comparison;
using study::ComparisonOptions;
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
  EXPECT_THAT(plot_efficiency(input()).script,
              HasSubstr("N = 16, B = 512 bytes, R = 1000 Mbit/s, d = 0.512 us, seed 42"));
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

// compare_networks, as a user runs it.

namespace {

using ring_sim::kBroken;
using ring_sim::kDone;
using ring_sim::kUsage;

CliRun compare_networks(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "compare_networks");
  return run_cli(run_command_line, std::move(arguments));
}

const char* const kPictures[] = {"latency_nodes", "latency_nodes_own_rates", "efficiency",    "round_trips",
                                 "embedding",     "timeline_alone",          "timeline_worst"};

struct Plots : PlotTest {
  /// On a small ring, so that it does not take long.
  static CliRun compare(const std::string& to) {
    return compare_networks({"--nodes", "4", "--payload", "64", "--seed", "9", "--plots", to});
  }
};

/// Width and height, from the chunk that begins every PNG. (W3C PNG specification, IHDR)
std::pair<unsigned, unsigned> size_of_png(const std::string& png) {
  const auto word = [&png](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<unsigned char>(png.at(i));
    return value;
  };
  return {word(16), word(20)};
}

TEST_F(Plots, WritesEveryPictureWithItsDataAndScript) {
  LIMB_RING_NEEDS_GNUPLOT();
  const CliRun said = compare(folder + "/plots");
  ASSERT_EQ(said.code, kDone) << said.errors;
  EXPECT_THAT(said.out, HasSubstr("seed 9"));
  for (const std::string name : kPictures) {
    const std::string path = folder + "/plots/" + name;
    EXPECT_THAT(said.errors, HasSubstr(name + ".png")) << "progress";
    EXPECT_THAT(read(path + ".gp"), HasSubstr(name + ".csv"));
    EXPECT_THAT(read(path + ".csv"), HasSubstr("\n"));
    const std::string png = read(path + ".png"), svg = read(path + ".svg");
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n") << name;
    EXPECT_EQ(size_of_png(png), std::make_pair(900u, 600u)) << name;
    EXPECT_GT(png.size(), 15'000u) << name << ": axes without curves take less";
    EXPECT_THAT(svg, HasSubstr("B = 64 bytes")) << name;
    EXPECT_THAT(svg, HasSubstr("seed 9")) << name;
  }
}

TEST_F(Plots, WithoutGnuplotEndBeforeAnythingIsMeasured) {
  ::setenv("PATH", "", 1);
  const CliRun said = compare(folder);
  EXPECT_EQ(said.code, kBroken);
  EXPECT_THAT(said.errors, HasSubstr("gnuplot-nox"));
  EXPECT_EQ(said.out, "");
}

TEST_F(Plots, NameTheFileForWhichTheDiskIsTooFull) {
  LIMB_RING_NEEDS_GNUPLOT();
  std::filesystem::create_symlink("/dev/full", folder + "/latency_nodes.csv");
  const CliRun said = compare(folder);
  EXPECT_EQ(said.code, kBroken);
  EXPECT_THAT(said.errors, HasSubstr(folder + "/latency_nodes.csv: not all could be written: No space left on device"));
}

TEST_F(Plots, IntoAFolderThatCannotBeMadeIsAUsageError) {
  std::ofstream(folder + "/file") << "in the way";
  const CliRun said = compare(folder + "/file/plots");
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("cannot make the folder " + folder + "/file/plots"));
}

TEST(Compare, RefusesWhatDoesNotFitIntoMemory) {
  const std::vector<std::vector<std::string>> all{{"--nodes", "254", "--payload", "1"},
                                                  {"--rate", "1kbit/s", "--relay-delay", "1s"},
                                                  {"--rate", "100Gbit/s", "--relay-delay", "1ms"}};
  for (const std::vector<std::string>& arguments : all) {
    const CliRun said = compare_networks(arguments);
    EXPECT_EQ(said.code, kUsage) << arguments[1];
    EXPECT_THAT(said.errors, HasSubstr("a full load of messages does not fit into memory: fewer --nodes"));
  }
}

TEST(Compare, EverythingThatHelpNamesIsCompleted) { expect_help_completed(compare_networks); }

}  // namespace

}  // namespace limb_ring::comparison
