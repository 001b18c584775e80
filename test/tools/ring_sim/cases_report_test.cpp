// ring_sim table, run and soak, as a user and a script see them.
#include <gmock/gmock.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "study/cases.h"
#include "support/temporary_folder.h"
#include "tools/completed_help.h"
#include "tools/ring_sim/command_line.h"
#include "tools/ring_sim/run_ring_sim.h"

namespace limb_ring::ring_sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

nlohmann::json json_of(const std::vector<std::string>& arguments) {
  return nlohmann::json::parse(ring_sim(arguments).out);
}

TEST(Table, HasARowForEachCaseUnderItsOwnName) {
  const nlohmann::json rows = json_of({"table", "--only", "--nodes", "4", "--json"});
  ASSERT_EQ(rows.size(), 10u);
  EXPECT_EQ(rows[0].at("case"), "alone");
  EXPECT_EQ(rows[0].at("nodes"), 4);
  EXPECT_EQ(rows[0].at("payload"), 512);
  EXPECT_EQ(rows[0].at("rate_bps"), 1000000000);
  EXPECT_EQ(rows[0].at("relay_delay_ns"), 512);
  EXPECT_EQ(rows[0].at("formula_us"), 6.24);
  EXPECT_EQ(rows[0].at("measured_us"), 6.24);
  EXPECT_TRUE(rows[7].at("measured_us").is_null()) << "occupancy is no time";
}

TEST(Table, IsCsvToo) {
  EXPECT_THAT(ring_sim({"table", "--only", "--nodes", "2", "--csv"}).out,
              HasSubstr("\nalone,2,512,1000000000,512,T + N d,5.216,5.216,0,,\n"));
}

TEST(Run, GivesTheDistributionAndTheSeed) {
  const nlohmann::json row = json_of({"run", "--case", "random", "--nodes", "3", "--seed", "9", "--json"});
  EXPECT_EQ(row.at("seed"), 9);
  EXPECT_LE(row.at("min_us").get<double>(), row.at("mean_us").get<double>());
  EXPECT_LE(row.at("p99_us").get<double>(), row.at("max_us").get<double>());
  EXPECT_EQ(row.at("trace_hash").get<std::string>().size(), 16u);
  EXPECT_EQ(json_of({"run", "--case", "random", "--nodes", "3", "--seed", "9", "--json"}), row);
}

TEST(Run, RefusesImpossibleValuesNamingTheOptionAndWhatIsAllowed) {
  const std::vector<std::vector<std::string>> wrong{{"--rate", "0"},          {"--rate", "fast"},  {"--nodes", "300"},
                                                    {"--nodes", "1"},         {"--payload", "0"},  {"--payload", "513"},
                                                    {"--relay-delay", "512"}, {"--case", "quick"}, {"--seed", "x"}};
  for (const auto& arguments : wrong) {
    std::vector<std::string> all{"run"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CliRun said = ring_sim(all);
    EXPECT_EQ(said.code, kUsage) << arguments[1];
    EXPECT_THAT(said.errors, HasSubstr(arguments[0])) << arguments[1];
  }
}

TEST(Run, RefusesATraceItCannotWrite) {
  const CliRun said = ring_sim({"run", "--trace", "/nowhere/trace"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("/nowhere/trace"));
}

TEST(Run, NamesTheFileForWhichTheDiskIsTooFull) {
  for (const char* option : {"--trace", "--capture"}) {
    const CliRun said = ring_sim({"run", option, "/dev/full"});
    EXPECT_EQ(said.code, kBroken) << option;
    EXPECT_THAT(said.errors, HasSubstr("/dev/full: not all could be written: No space left on device")) << option;
  }
}

TEST(Soak, SaysHowManySeedsAndThatNothingBroke) {
  const nlohmann::json row = json_of({"soak", "--seeds", "5", "--first", "100", "--json"});
  EXPECT_EQ(row.at("seeds"), 5);
  EXPECT_EQ(row.at("first_seed"), 100);
  EXPECT_GT(row.at("packet_hops").get<std::uint64_t>(), 1000u);
}

TEST(Soak, RefusesSeedsThatNeitherFirstNorAScenarioCouldTake) {
  const CliRun said = ring_sim({"soak", "--seeds", "2", "--first", "9223372036854775807"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("--first: the last of 2 seeds from 9223372036854775807 on would be beyond it"));
  EXPECT_EQ(ring_sim({"soak", "--seeds", "1", "--first", "9223372036854775807"}).code, kDone);
}

TEST(Soak, PrintsHashesOnlyAsText) {
  const CliRun said = ring_sim({"soak", "--seeds", "1", "--first", "100", "--hashes", "--json"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("--hashes"));
}

TEST(Soak, MakesTheFolderForWhatItShrinks) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(ring_sim({"soak", "--seeds", "1", "--first", "100", "--shrink", folder.path() + "/new/failures"}).code,
            kDone);
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() + "/new/failures"));
  const CliRun said = ring_sim({"soak", "--seeds", "1", "--first", "100", "--shrink", "/dev/null/failures"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("--shrink: cannot make the folder /dev/null/failures: Not a directory"));
}

TEST(Explore, NamesAPlaceThatTheRunDoesNotHave) {
  const CliRun said = ring_sim({"explore", "--only", "99999:lost"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("--only: there is no place 99999, only 0 to "));
  EXPECT_EQ(ring_sim({"explore", "--only", "0:lost"}).code, kDone);
}

// As 'ringctl up' does: round a broken cable the second line leads over the other one.
TEST(Explore, ARingOfTwoFoldsBackToo) {
  const CliRun said =
      ring_sim({"explore", "--nodes", "2", "--redundancy", "foldback", "--open-chain", "--only", "none"});
  EXPECT_EQ(said.code, kDone) << said.errors;
}

TEST(Explore, ASingleRunRefusesOptionsForManyRuns) {
  for (const std::vector<std::string>& bound :
       {std::vector<std::string>{"--faults", "2"}, {"--places", "5"}, {"--threads", "1"}, {"--all-runs"}}) {
    std::vector<std::string> arguments{"explore", "--only", "none"};
    arguments.insert(arguments.end(), bound.begin(), bound.end());
    const CliRun said = ring_sim(arguments);
    EXPECT_EQ(said.code, kUsage) << bound.front();
    EXPECT_THAT(said.errors, AllOf(HasSubstr("--only"), HasSubstr(bound.front())));
  }
}

TEST(Commands, ExplainThemselvesAndTheirExitCodes) {
  for (const char* command : {"table", "run", "plan", "soak"}) {
    const CliRun said = ring_sim({command, "--help"});
    EXPECT_EQ(said.code, kDone) << command;
    EXPECT_THAT(said.out, AllOf(HasSubstr(command), HasSubstr("Exit code: 0 done"))) << command;
  }
}

TEST(Commands, OfCasesExplainEachOfThem) {
  for (const char* command : {"table", "run"}) {
    const CliRun said = ring_sim({command, "--help"});
    for (const study::Case which : study::kCases)
      EXPECT_THAT(said.out, HasSubstr(std::string("\n  ") + to_string(which) + ": ")) << command;
  }
}

TEST(Commands, EverythingThatHelpNamesIsCompleted) { expect_help_completed(ring_sim); }

}  // namespace
}  // namespace limb_ring::ring_sim
