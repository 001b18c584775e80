#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "support/own_folder.h"
#include "tools/ringctl/run_ringctl.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

CliRun run_scenarios(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"scenario", "run"});
  return ringctl(std::move(arguments));
}

const char* const kGood = "scenario: nothing happens\nnodes: 4\nsteps: [{at: 1ms}]\nalways: [{node: all, is: up}]\n";
const char* const kUnmet = "scenario: a surprise\nnodes: 4\nsteps: [{when: {node: 0, is: down}, within: 1ms}]\n";

using ScenarioCommand = test::OwnFolder;

TEST_F(ScenarioCommand, EndsWithZeroIfAllWasAsExpected) {
  const CliRun said = run_scenarios({write("good.yaml", kGood)});
  EXPECT_EQ(said.code, kDone);
  EXPECT_THAT(said.out, HasSubstr("end: all as expected"));
}

TEST_F(ScenarioCommand, EndsWithOneAndSaysWhatWasSeenInstead) {
  const CliRun said = run_scenarios({write("good.yaml", kGood), write("unmet.yaml", kUnmet), "--seed", "9"});
  EXPECT_EQ(said.code, kNotDone);
  EXPECT_THAT(said.out, AllOf(HasSubstr("a surprise (seed 9)"), HasSubstr("seen instead: node0 is up")));
  EXPECT_THAT(said.out, AllOf(HasSubstr("2 scenarios: 1 not as expected:\n  "), EndsWith("unmet.yaml\n")));
}

TEST_F(ScenarioCommand, SumsUpIfThereAreSeveral) {
  EXPECT_THAT(run_scenarios({write("good.yaml", kGood), write("as_good.yaml", kGood)}).out,
              EndsWith("2 scenarios: all as expected\n"));
}

TEST_F(ScenarioCommand, EndsWithTwoForABadFileBeforeAnyIsRun) {
  const CliRun said =
      run_scenarios({write("good.yaml", kGood), write("bad.yaml", "scenario: x\nnodes: 4\nstep: []\n")});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_EQ(said.out, "");
  EXPECT_THAT(said.errors, HasSubstr("bad.yaml:3:1: entry 'step': is unknown"));
}

TEST_F(ScenarioCommand, AReportNamesAFileThatIsRefused) {
  const std::string junit = folder + "/junit.xml";
  for (const char* bad : {"scenario: x\nnodes: 4\nstep: []\n", "scenario: x\nnodes: 4\nsteps: []\n"}) {
    const CliRun said = run_scenarios({write("good.yaml", kGood), write("bad.yaml", bad), "--junit", junit, "--json"});
    EXPECT_EQ(said.code, kUsage);
    EXPECT_EQ(said.out, "");
    std::ostringstream xml;
    xml << std::ifstream(junit).rdbuf();
    EXPECT_THAT(xml.str(), AllOf(HasSubstr("tests=\"1\" failures=\"0\" errors=\"1\""), HasSubstr("bad: "),
                                 HasSubstr("<error message=\"" + folder + "/bad.yaml:")));
  }
}

TEST_F(ScenarioCommand, AScenarioThatExpectsNothingIsNotPassed) {
  const CliRun said = run_scenarios({write("idle.yaml", "scenario: x\nnodes: 4\nsteps: [{at: 1ms, do: {kill: 1}}]\n")});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_EQ(said.out, "");
  EXPECT_THAT(said.errors, AllOf(HasSubstr("idle.yaml: nothing is expected"), HasSubstr("when and within")));
}

TEST_F(ScenarioCommand, AScenarioInWhichNoTimePassesIsNotPassed) {
  const CliRun said =
      run_scenarios({write("idle.yaml", "scenario: x\nnodes: 4\nsteps: []\nalways: [{node: all, is: up}]\n")});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, AllOf(HasSubstr("idle.yaml: it has no step"), HasSubstr("steps: [{at: 1s}]")));
}

TEST_F(ScenarioCommand, ListsAFolderAndNamesWhatIsNotAScenario) {
  write("a_ring.yaml", "ring: mine\nnodes: [{id: 0, name: a}, {id: 1, name: b}]\n");
  write("b_good.yaml", kGood);
  write("c_text.yaml", "- just\n- a list\n");
  write("d_idle.yml", "scenario: later\nnodes: 4\nsteps: []\n");
  const CliRun said = ringctl({"scenario", "list", folder});
  EXPECT_EQ(said.code, kDone);
  EXPECT_THAT(said.out, AllOf(HasSubstr("nothing happens"), HasSubstr("later (expects nothing)")));
  EXPECT_THAT(said.errors, AllOf(HasSubstr("not a scenario: "), HasSubstr("a_ring.yaml"), HasSubstr("c_text.yaml")));
}

TEST_F(ScenarioCommand, AFolderWithoutScenariosIsRefusedEvenAfterOneWithScenarios) {
  const std::string full = folder + "/full", empty = folder + "/empty";
  std::filesystem::create_directory(full);
  std::filesystem::create_directory(empty);
  write("full/text.yaml", "- just\n- a list\n");
  const CliRun said = ringctl({"scenario", "list", full, empty});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("/empty: no scenario there (*.yaml)"));
}

TEST_F(ScenarioCommand, AFileToListThatIsNotAScenarioIsAnError) {
  EXPECT_EQ(ringctl({"scenario", "list", write("bad.yaml", "- a list\n")}).code, kUsage);
}

TEST_F(ScenarioCommand, HasARingOfItsOwnAndATransportOnlyLive) {
  const std::string good = write("good.yaml", kGood);
  EXPECT_THAT(run_scenarios({good, "--ring", "mine"}).errors, HasSubstr("a scenario has a ring of its own"));
  EXPECT_EQ(run_scenarios({good, "--transport", "udp"}).code, kUsage);
  EXPECT_EQ(run_scenarios({good, "--sim", "--live"}).code, kUsage);
}

TEST_F(ScenarioCommand, SaysWhyAScenarioIsNotForLiveDaemons) {
  const CliRun said = run_scenarios({write("only.yaml", std::string(kGood) + "only: sim\n"), "--live"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("only.yaml: only under the virtual clock (--sim):\n  only: sim"));
}

TEST_F(ScenarioCommand, NamesTheFileForWhichTheDiskIsTooFull) {
  for (const char* option : {"--junit", "--capture"}) {
    const CliRun said = run_scenarios({write("good.yaml", kGood), option, "/dev/full"});
    EXPECT_EQ(said.code, kNotDone) << option;
    EXPECT_THAT(said.errors, HasSubstr("/dev/full: not all could be written: No space left on device")) << option;
  }
}

TEST_F(ScenarioCommand, ReportsWhatWasFoundEvenIfSomethingFailsAfterwards) {
  const std::string report = folder + "/report.xml";
  const CliRun said = run_scenarios({write("good.yaml", kGood), "--json", "--junit", report, "--capture", "/dev/full"});
  EXPECT_EQ(said.code, kNotDone);
  const auto rows = nlohmann::json::parse(said.out);
  EXPECT_EQ(rows[0].at("met"), true);
  EXPECT_EQ(rows[0].at("log").size(), 1u);
  EXPECT_NE(std::filesystem::file_size(report), 0u);
}

TEST_F(ScenarioCommand, AFileThatCannotBeWrittenIsNamedBeforeAnyIsRun) {
  for (const char* option : {"--junit", "--capture"}) {
    const CliRun said = run_scenarios({write("good.yaml", kGood), option, folder + "/none/x"});
    EXPECT_EQ(said.code, kUsage) << option;
    EXPECT_THAT(said.errors, HasSubstr("/none/x: cannot be written: No such file or directory")) << option;
    EXPECT_EQ(said.out, "") << option;
  }
}

TEST_F(ScenarioCommand, DoesNotWriteOverAScenario) {
  const std::string path = write("good.yaml", kGood);
  for (const char* option : {"--junit", "--capture"}) {
    const CliRun said = run_scenarios({path, option, path});
    EXPECT_EQ(said.code, kUsage) << option;
    EXPECT_THAT(said.errors, HasSubstr("good.yaml is a scenario that is to be run, and would be lost")) << option;
    EXPECT_EQ(run_scenarios({path}).code, kDone) << option;
  }
}

TEST_F(ScenarioCommand, AddsNoLogToAScenario) {
  const std::string path = write("good.yaml", kGood);
  const CliRun said = run_scenarios({path, "--virtual", "--log", path});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("good.yaml is a scenario that is to be run, and would be lost"));
}

TEST_F(ScenarioCommand, NeedsADifferentFileForEachOutput) {
  const std::string path = write("good.yaml", kGood), out = folder + "/out";
  for (const char* there : {"not yet", "already"}) {
    const CliRun said = run_scenarios({path, "--junit", out, "--capture", folder + "/./out"});
    EXPECT_EQ(said.code, kUsage) << there;
    EXPECT_THAT(said.errors, HasSubstr("--junit and --capture both name " + folder + "/./out; each needs a file"));
    write("out", "");
  }
  EXPECT_EQ(run_scenarios({path, "--junit", "/dev/null", "--capture", "/dev/null"}).code, kDone);
}

TEST_F(ScenarioCommand, IsNotShrunkOntoItsOwnFile) {
  const std::string path = write("unmet.yaml", kUnmet);
  const CliRun said = ringctl({"scenario", "shrink", path, "-o", path});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("--out names the scenario itself: " + path + " would be lost"));
}

TEST_F(ScenarioCommand, IsNotShrunkIfTheFileCannotBeWritten) {
  const std::string path = write("good.yaml", kGood);
  const CliRun missing = ringctl({"scenario", "shrink", path, "-o", folder + "/none/x.yaml"});
  EXPECT_EQ(missing.code, kUsage);
  EXPECT_THAT(missing.errors, HasSubstr("--out " + folder + "/none/x.yaml: cannot be written: No such file or"));
  const CliRun is_folder = ringctl({"scenario", "shrink", path, "-o", folder});
  EXPECT_EQ(is_folder.code, kUsage);
  EXPECT_THAT(is_folder.errors, HasSubstr("--out " + folder + ": cannot be written: Is a directory"));
}

TEST_F(ScenarioCommand, LeavesTheFileOfTheShrunkOneAloneIfNothingIsFound) {
  const std::string path = write("good.yaml", kGood), out = write("out.yaml", "as it was");
  EXPECT_EQ(ringctl({"scenario", "shrink", path, "-o", out}).code, kNotDone);
  EXPECT_EQ(std::filesystem::file_size(out), 9u);
  EXPECT_EQ(ringctl({"scenario", "shrink", path, "-o", folder + "/new.yaml"}).code, kNotDone);
  EXPECT_FALSE(std::filesystem::exists(folder + "/new.yaml"));
}

TEST_F(ScenarioCommand, ItsJsonIsUtf8EvenIfAFileNameIsNot) {
  const CliRun said = run_scenarios({write("good\xff.yaml", kGood), "--json"});
  EXPECT_EQ(said.code, kDone) << said.errors;
  EXPECT_THAT(said.out, HasSubstr("good\xef\xbf\xbd.yaml"));
}

TEST_F(ScenarioCommand, WritesJunitAndJson) {
  const std::string junit = folder + "/junit.xml";
  const CliRun said = run_scenarios({write("unmet.yaml", kUnmet), "--junit", junit, "--json"});
  EXPECT_THAT(said.out, AllOf(StartsWith("["), HasSubstr("\"met\": false")));
  std::ostringstream xml;
  xml << std::ifstream(junit).rdbuf();
  EXPECT_THAT(xml.str(), HasSubstr("<failure message="));
}

}  // namespace
}  // namespace limb_ring::ringctl
