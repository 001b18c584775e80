// Completion: the words that may come next on a command line.
#include "tools/common/man_page.h"

#include <gmock/gmock.h>

#include "tools/common/command_line.h"

namespace limb_ring::cli {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A program like ringctl.
class Completion : public testing::Test {
 protected:
  Completion() {
    app.add_option("--ring", ring, "Name of the ring");
    CLI::App* send = app.add_subcommand("send", "Send packets");
    send->fallthrough();
    send->add_option("TO,--to", to, "Node to send to");
    send->add_option("--from", from, "Node that sends");
    send->add_flag("--loud", loud, "Say so");
    app.add_subcommand("status", "Show all nodes")->add_option("NODE", from, "This node");
    CLI::App* fault = app.add_subcommand("fault", "Break it");
    fault->add_subcommand("cut", "A line")->add_option("WHERE", to, "The line")->type_name("A:B");
    fault->add_subcommand("kill", "Nodes")->add_option("WHERE", to, "Nodes")->type_name("NODE");
    fault->add_subcommand("keep", "Nothing");
  }

  std::vector<std::string> next(const std::vector<std::string>& words) { return completions(app, words, names); }

  static std::vector<std::string> names(const std::string& wanted) {
    if (wanted == "--ring") return {"robot", "bench"};
    if (wanted == "NODE" || wanted == "TO" || wanted == "--from") return {"knee", "hip", "head"};
    return {};
  }

  std::string ring, from, to;
  bool loud = false;
  CLI::App app{"A test.", "program"};
};

TEST_F(Completion, SubcommandsByTheirBeginning) {
  EXPECT_THAT(next({""}), ElementsAre("fault", "help", "send", "status"));
  EXPECT_THAT(next({"s"}), ElementsAre("send", "status"));
  EXPECT_THAT(next({"fault", "k"}), ElementsAre("keep", "kill"));
  EXPECT_THAT(next({"x"}), IsEmpty());
}

TEST_F(Completion, OptionsOfASubcommandAndOfThoseAbove) {
  EXPECT_THAT(next({"send", "--"}), ElementsAre("--from", "--help", "--loud", "--ring", "--to"));
  EXPECT_THAT(next({"send", "--l"}), ElementsAre("--loud"));
}

TEST_F(Completion, OnlyOptionsThatMayStandThere) { EXPECT_THAT(next({"status", "--"}), ElementsAre("--help")); }

TEST_F(Completion, AfterHelpAsWithoutIt) {
  EXPECT_THAT(next({"help", "s"}), ElementsAre("send", "status"));
  EXPECT_THAT(next({"help", "fault", "k"}), ElementsAre("keep", "kill"));
}

TEST_F(Completion, NamesIfANameIsWanted) {
  EXPECT_THAT(next({"status", "h"}), ElementsAre("head", "hip"));
  EXPECT_THAT(next({"send", "--from", ""}), ElementsAre("head", "hip", "knee"));
  EXPECT_THAT(next({"send", ""}), ElementsAre("head", "hip", "knee"));
  EXPECT_THAT(next({"--ring", "b"}), ElementsAre("bench"));
  EXPECT_THAT(next({"fault", "kill", "k"}), ElementsAre("knee"));
}

TEST_F(Completion, NothingIfNothingIsKnown) {
  EXPECT_THAT(next({"fault", "cut", ""}), IsEmpty());
  EXPECT_THAT(next({}), IsEmpty());
}

TEST_F(Completion, AFlagWantsNoValue) { EXPECT_THAT(next({"send", "--loud", "k"}), ElementsAre("knee")); }

TEST_F(Completion, EveryProgramAnswersComplete) {
  EXPECT_EQ(read(app, {"complete", "s"}), "send\nstatus\n");
  EXPECT_EQ(read(app, {"complete", "--ring", "r"}, names), "robot\n");
  EXPECT_EQ(read(app, {"complete", "--v"}), "--version\n");
}

}  // namespace
}  // namespace limb_ring::cli
