// compare_networks, as a user runs it.
#include <gmock/gmock.h>

#include <filesystem>

#include "comparison/command_line.h"
#include "comparison/test/plot_folder.h"
#include "tools/completed_help.h"
#include "tools/ring_sim/command_line.h"
#include "tools/run_cli.h"

namespace limb_ring::comparison {
namespace {

using ring_sim::kBroken;
using ring_sim::kDone;
using ring_sim::kUsage;
using testing::HasSubstr;

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

TEST_F(Plots, NameTheFileThatAFullDiskHasNoRoomFor) {
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

TEST(Compare, AllThatHelpNamesIsCompleted) { expect_help_completed(compare_networks); }

}  // namespace
}  // namespace limb_ring::comparison
