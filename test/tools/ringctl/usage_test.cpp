// What ringctl says to wrong command lines, before it looks for any daemon.
#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/own_folder.h"
#include "tools/completed_help.h"
#include "tools/ringctl/hosts.h"
#include "tools/ringctl/run_ringctl.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Usage = test::OwnFolder;

/// Each command, as the shell is offered them: "up", "clock pace" ...
std::vector<std::vector<std::string>> all_commands(const std::vector<std::string>& above = {}) {
  std::vector<std::string> next = above;
  next.emplace_back();
  std::vector<std::vector<std::string>> all;
  for (const std::string& name : completed(ringctl, next)) {
    if (name == "help") continue;
    next.back() = name;
    all.push_back(next);
    const auto below = all_commands(next);
    all.insert(all.end(), below.begin(), below.end());
  }
  return all;
}

TEST_F(Usage, EverySubcommandExplainsItselfAndItsExitCodes) {
  for (const std::vector<std::string>& words : all_commands()) {
    std::vector<std::string> with_help = words;
    with_help.push_back("--help");
    const CliRun said = ringctl(with_help);
    EXPECT_EQ(said.code, kDone) << words.back();
    EXPECT_THAT(said.out, AllOf(HasSubstr(words.back()), HasSubstr("Exit code: 0 done")));
  }
}

TEST_F(Usage, EverythingThatHelpNamesIsCompleted) { expect_help_completed(ringctl); }

TEST_F(Usage, AMissingSubcommandIsRefused) { EXPECT_EQ(ringctl({}).code, kUsage); }

TEST_F(Usage, UnknownSubcommandIsRefusedWithAGuess) {
  EXPECT_EQ(ringctl({"fly"}).code, kUsage);
  const CliRun said = ringctl({"stauts"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors,
              HasSubstr("'ringctl stauts' is unknown, did you mean 'status'? There are: new, check, up, down"));
}

TEST_F(Usage, WhatIsMissingIsNamedAsTheUsageLineNamesIt) {
  EXPECT_THAT(ringctl({"ping"}).errors, HasSubstr("TO is required"));
  EXPECT_THAT(ringctl({"send", "--data", "x"}).errors, HasSubstr("--from is required"));
}

TEST_F(Usage, SizesOutsideAPacketAreRefusedWithTheRange) {
  for (const char* size : {"0", "513", "-1", "many"}) {
    const CliRun said = ringctl({"send", "--from", "0", "--to", "1", "--size", size});
    EXPECT_EQ(said.code, kUsage) << size;
    EXPECT_THAT(said.errors, AllOf(HasSubstr("--size"), HasSubstr("1"), HasSubstr("512"))) << size;
    EXPECT_EQ(ringctl({"ping", "--from", "0", "--to", "1", "--size", size}).code, kUsage);
  }
}

TEST_F(Usage, BadPriorityIsRefusedWithTheRange) {
  const CliRun said = ringctl({"send", "--from", "0", "--to", "1", "--size", "8", "--priority", "4"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, AllOf(HasSubstr("--priority"), HasSubstr("4"), HasSubstr("3")));
}

TEST_F(Usage, OnAnotherHostTheRingIsNamedOnce) {
  EXPECT_THAT(arguments_there("robot", {"wait", "up"}), ElementsAre("--ring", "robot", "wait", "up"));
  EXPECT_THAT(arguments_there("robot", {"wait", "--ring", "robot"}), ElementsAre("wait", "--ring", "robot"));
  EXPECT_THAT(arguments_there("robot", {"--ring=robot", "wait"}), ElementsAre("--ring=robot", "wait"));
  EXPECT_THAT(arguments_there("", {"up"}), ElementsAre("up"));
}

TEST_F(Usage, ARingIsNamedOnceByItsArgumentOrByTheOption) {
  for (const char* command : {"status", "judge"}) {
    std::vector<std::string> words{command, "leg"};
    if (words[0] == "judge") words.insert(words.begin(), "traffic");
    const CliRun none = ringctl(words);
    EXPECT_EQ(none.code, kNoRing) << command;
    EXPECT_THAT(none.errors, HasSubstr("ring leg does not run")) << command;
    words.insert(words.begin(), {"--ring", "arm"});
    const CliRun two = ringctl(words);
    EXPECT_EQ(two.code, kUsage) << command;
    EXPECT_THAT(two.errors, HasSubstr("RING and --ring name two rings")) << command;
  }
}

TEST_F(Usage, ChannelOfTheNetworkControllersIsRefused) {
  for (const char* channel : {"1", "+1", "01", "control"}) {
    const CliRun said = ringctl({"send", "--from", "0", "--to", "1", "--size", "8", "--channel", channel});
    EXPECT_EQ(said.code, kUsage) << channel;
    EXPECT_THAT(said.errors, HasSubstr("network controllers")) << channel;
  }
}

TEST_F(Usage, SendNeedsExactlyOneKindOfData) {
  EXPECT_EQ(ringctl({"send", "--from", "0", "--to", "1"}).code, kUsage);
  EXPECT_EQ(ringctl({"send", "--from", "0", "--to", "1", "--size", "8", "--data", "x"}).code, kUsage);
}

TEST_F(Usage, ATextThatIsTooLongIsRefusedWithTheRange) {
  const CliRun said = ringctl({"send", "--from", "0", "--to", "1", "--data", std::string(513, 'x')});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, AllOf(HasSubstr("513 bytes"), HasSubstr("1 to 512")));
}

TEST_F(Usage, ChannelsAndCountsAreTakenAsPeopleWriteThem) {
  EXPECT_EQ(ringctl({"send", "--from", "0", "--to", "1", "--size", "8", "--channel", "joint", "--count", "1e3"}).code,
            kNoRing);
  const CliRun said = ringctl({"send", "--from", "0", "--to", "1", "--size", "8", "--channel", "jiont"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("control, joint, topic, user"));
}

TEST_F(Usage, BadHexadecimalDigitIsNamed) {
  const CliRun said = ringctl({"send", "--from", "0", "--to", "1", "--hex", "0xfg"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("'g' at position 4"));
}

TEST_F(Usage, AnInterruptIsAPacketOrAnInputThatIsPulled) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong{
      {{"interrupt", "--from", "0"}, "either FACTOR, with --to NODE, or --input N"},
      {{"interrupt", "--from", "0", "1", "--input", "1"}, "either FACTOR, with --to NODE, or --input N"},
      {{"interrupt", "--from", "0", "1"}, "--to is required"},
      {{"interrupt", "--from", "0", "--to", "1", "--input", "1"}, "--to"}};
  for (const auto& [arguments, about] : wrong) {
    const CliRun said = ringctl(arguments);
    EXPECT_EQ(said.code, kUsage) << about;
    EXPECT_THAT(said.errors, HasSubstr(about));
  }
}

TEST_F(Usage, OnlyAWatchedStatusHasAnInterval) {
  EXPECT_EQ(ringctl({"status", "--interval", "1"}).code, kUsage);
  EXPECT_EQ(ringctl({"status", "--once"}).code, kUsage);
  EXPECT_EQ(ringctl({"status", "--watch", "--pids"}).code, kUsage);
  EXPECT_THAT(ringctl({"status", "--watch", "--json"}).errors, HasSubstr("--once"));
}

TEST_F(Usage, ARingIsNotNamedTogetherWithAllRings) {
  EXPECT_EQ(ringctl({"status", "--rings"}).out, "no ring is running\n");
  EXPECT_THAT(ringctl({"--ring", "leg", "status", "--rings"}).errors,
              HasSubstr("--rings shows all rings; leave it out"));
  for (const char* other : {"leg", "--watch", "--pids"})
    EXPECT_EQ(ringctl({"status", "--rings", other}).code, kUsage) << other;
}

TEST_F(Usage, HelpListsTheCommandsInSectionsByWhatTheyAreFor) {
  const std::string help = ringctl({"--help"}).out;
  std::size_t at = 0;
  for (const char* part : {"Start and end a ring:\n  new ", "Look at it:\n  status ", "Act on it:\n  send ",
                           "Break and test it:\n  fault ", "For several hosts and for nodes of your own:\n  hosts "}) {
    const std::size_t found = help.find(part, at);
    ASSERT_NE(found, std::string::npos) << part << help;
    at = found;
  }
}

TEST_F(Usage, FactorsAndInputsEndAtSeven) {
  EXPECT_EQ(ringctl({"interrupt", "--from", "0", "--to", "1", "8"}).code, kUsage);
  EXPECT_EQ(ringctl({"interrupt", "--from", "0", "--input", "8"}).code, kUsage);
}

TEST_F(Usage, SaysSoIfNoRingRuns) {
  const CliRun said = ringctl({"status"});
  EXPECT_EQ(said.code, kNoRing);
  EXPECT_THAT(said.errors, AllOf(HasSubstr("no ring is running"), HasSubstr(folder)));
}

TEST_F(Usage, AFolderOfAnotherUserIsNotTakenForOneWithoutRings) {
  write("limb_ring", "in its place something that is no folder");  // one that cannot be read, also for root
  const CliRun said = ringctl({"status"});
  EXPECT_EQ(said.code, kNoRing);
  EXPECT_THAT(said.errors, HasSubstr("Not a directory"));
  EXPECT_THAT(ringctl({"--ring", "legs", "status"}).errors, HasSubstr("Not a directory"));
}

TEST_F(Usage, RingThatDoesNotRunIsNamed) {
  for (const char* command : {"status", "stop", "down"}) {
    const CliRun said = ringctl({command, "--ring", "legs"});
    EXPECT_EQ(said.code, kNoRing) << command;
    EXPECT_THAT(said.errors, HasSubstr("ring legs")) << command;
  }
}

TEST_F(Usage, AnInvalidRingNameIsRefused) {
  EXPECT_EQ(ringctl({"--ring", "../etc", "status"}).code, kUsage);
  EXPECT_EQ(ringctl({"up", "--nodes", "2", "--ring", "a/b"}).code, kUsage);
}

TEST_F(Usage, UpRefusesABrokenFileBeforeAnythingStarts) {
  const std::string file = write("broken.yaml", "ring: r\nnodes: [{id: 999, name: a}, {id: 1, name: b}]\n");
  const CliRun said = ringctl({"up", file});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, AllOf(HasSubstr(file), HasSubstr("999")));
  EXPECT_FALSE(std::filesystem::exists(folder + "/limb_ring"));
}

TEST_F(Usage, UpNeedsAFileOrANumberOfNodes) {
  EXPECT_EQ(ringctl({"up"}).code, kUsage);
  EXPECT_EQ(ringctl({"up", "ring.yaml", "--nodes", "4"}).code, kUsage);
  EXPECT_EQ(ringctl({"up", "--nodes", "1"}).code, kUsage);
  EXPECT_EQ(ringctl({"up", "--nodes", "4", "--transport", "smoke"}).code, kUsage);
}

TEST_F(Usage, AFileIsNeverStandardOutputIfTheReportGoesThere) {
  const std::vector<std::vector<std::string>> all{
      {"up", "--nodes", "2", "--clock", "virtual", "--for", "0.001", "--capture", "-"},
      {"scenario", "run", "walk.yaml", "--virtual", "--log", "-"},
      {"hosts", "key", "-"}};
  for (const auto& arguments : all) {
    const CliRun said = ringctl(arguments);
    EXPECT_EQ(said.code, kUsage) << arguments.front();
    EXPECT_THAT(said.errors, HasSubstr("-: names no file here")) << arguments.front();
    EXPECT_FALSE(std::filesystem::remove("-")) << arguments.front();
  }
}

TEST_F(Usage, TrafficWhySaysWhatIsWrongWithItsArguments) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong{
      {{"traffic", "why"}, "either FILE, a capture, or --live"},
      {{"traffic", "why", "walk.pcapng", "--live"}, "either FILE, a capture, or --live"},
      {{"traffic", "why", "walk.pcapng", "--for", "5s"}, "with --live"},
      {{"traffic", "why", "--live", "--for", "soon"}, "--for: 'soon' is not a time"},
      {{"traffic", "why", "--live", "--at", "5ms"}, "--at"},
      {{"traffic", "why", "walk.pcapng", "--sequence", "8"}, "--sequence"},
      {{"traffic", "why", "walk.pcapng", "-n", "-1"}, "--count"},
      {{"traffic", "why", "no_such.pcapng"}, "no_such.pcapng: cannot be read"}};
  for (const auto& [arguments, about] : wrong) {
    const CliRun said = ringctl(arguments);
    EXPECT_EQ(said.code, kUsage) << about;
    EXPECT_THAT(said.errors, HasSubstr(about));
  }
}

TEST_F(Usage, TrafficWhyTakesAPlainNumberOfSecondsAsOthersDo) {
  EXPECT_EQ(ringctl({"traffic", "why", "--live", "--for", "1"}).code, kNoRing);
}

TEST_F(Usage, TrafficShowDoesNotWriteOverTheFileThatItReads) {
  write("walk.pcapng", "all that there is");
  const std::string file = folder + "/walk.pcapng", roundabout = folder + "/./walk.pcapng";
  const CliRun said = ringctl({"traffic", "show", "-r", file, "-w", roundabout});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, HasSubstr("name the same file"));
  EXPECT_EQ(std::filesystem::file_size(file), 17u);
}

TEST_F(Usage, SeedsAreWholeNumbersThatAFileMayHave) {
  for (const char* command : {"run", "shrink"})
    for (const char* seed : {"-1", "18446744073709551615", "foo"}) {
      const CliRun said = ringctl({"scenario", command, "walk.yaml", "--seed", seed});
      EXPECT_EQ(said.code, kUsage) << seed;
      EXPECT_THAT(said.errors, AllOf(HasSubstr("--seed"), HasSubstr("9223372036854775807"))) << seed;
    }
}

}  // namespace
}  // namespace limb_ring::ringctl
