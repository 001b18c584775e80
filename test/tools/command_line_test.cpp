// What every program prints for a wrong command line, and for --help and --version.
#include "tools/common/command_line.h"

#include <gmock/gmock.h>

namespace limb_ring::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A program like ringctl: subcommands, one of them with its own, a group of options.
class Program : public testing::Test {
 protected:
  Program() {
    app.require_subcommand(1);
    app.add_option("--ring", ring, "Name of the ring");
    CLI::App* send = app.add_subcommand("send", "Send packets");
    send->fallthrough();
    send->add_option("--from", from, "Node that sends")->required();
    send->add_option("--count", count, "How many, 1 to 9")->transform(whole(1, 9));
    CLI::App* data = send->add_option_group("data", "What to send");
    data->add_option("--text", text, "This text");
    data->add_option("--size", size, "So many bytes");
    data->require_option(1);
    app.add_subcommand("status", "Show all nodes")->fallthrough();
    CLI::App* fault = app.add_subcommand("fault", "Break it");
    fault->require_subcommand(1);
    fault->add_subcommand("cut", "A line");
    fault->add_subcommand("heal", "A line");
  }

  std::string refusal(std::vector<std::string> arguments) {
    try {
      read(app, std::move(arguments));
      return "accepted";
    } catch (const WrongCommandLine& wrong) {
      return wrong.what();
    }
  }

  CLI::App app{"A program", "prog"};
  std::string ring, from, text;
  unsigned count = 1, size = 1;
};

TEST_F(Program, GuessesTheSubcommandThatWasMeant) {
  EXPECT_EQ(refusal({"stauts"}), "'prog stauts' is unknown, did you mean 'status'? There are: send, status, fault");
  EXPECT_EQ(refusal({"dance"}), "'prog dance' is unknown. There are: send, status, fault");
  EXPECT_EQ(refusal({"--ring", "r", "sned"}),
            "'prog sned' is unknown, did you mean 'send'? There are: send, status, fault");
  EXPECT_EQ(refusal({"fault", "cutt"}), "'prog fault cutt' is unknown, did you mean 'cut'? There are: cut, heal");
  EXPECT_THAT(refusal({"stauts", "--help"}), HasSubstr("'prog stauts' is unknown"));
}

TEST_F(Program, IgnoresTheArgumentsThatRoslaunchAddsForNodes) {
  EXPECT_EQ(refusal({"status", "__name:=status", "__log:=/tmp/status.log"}), "accepted");
  EXPECT_EQ(refusal({"send", "--from", "a", "--text", "hello", "joint_states:=state", "tf:=/tf", "__name:=send"}),
            "accepted");
  EXPECT_EQ(text, "hello");
  EXPECT_EQ(refusal({"send", "--from", "a", "--text", "to:=b"}), "accepted");
  EXPECT_EQ(text, "to:=b");
  EXPECT_THAT(refusal({"status", "joint_states:=state"}), HasSubstr("'joint_states:=state' is one argument too many"));
}

TEST_F(Program, DoesNotTakeAnEmptyWordForAnOptionThatIsNotGiven) {
  EXPECT_EQ(refusal({"send", "--from", "", "--text", "hello"}), "--from is empty: Node that sends");
  EXPECT_EQ(refusal({"send", "--from", "a", "--text", ""}), "--text is empty: This text");
  EXPECT_EQ(refusal({"--ring", "", "status"}), "--ring is empty: Name of the ring");
}

TEST_F(Program, ListsTheSubcommandsIfNoneIsGiven) {
  EXPECT_EQ(refusal({}), "'prog' needs one of: send, status, fault; 'prog --help' says more");
  EXPECT_EQ(refusal({"fault"}), "'prog fault' needs one of: cut, heal; 'prog fault --help' says more");
}

TEST_F(Program, GuessesTheOptionThatWasMeantAlsoOneOfAGroupOrOfTheWhole) {
  EXPECT_EQ(refusal({"send", "--form", "a", "--from", "b", "--text", "x"}),
            "there is no option --form, did you mean '--from'? 'prog send --help' says more");
  EXPECT_THAT(refusal({"send", "--from", "b", "--txt=x", "--size", "2"}), HasSubstr("did you mean '--text'?"));
  EXPECT_THAT(refusal({"status", "--rnig", "r"}), HasSubstr("did you mean '--ring'?"));
}

TEST_F(Program, AnOptionBeforeItsSubcommandIsRefusedWithItsPlace) {
  EXPECT_EQ(refusal({"--count", "3", "send", "--from", "a", "--text", "x"}),
            "--count belongs behind the subcommand: prog send --count");
  EXPECT_EQ(refusal({"--text=x", "send", "--from", "a"}), "--text belongs behind the subcommand: prog send --text");
}

TEST_F(Program, NamesWhatIsMissingOrTooMuch) {
  EXPECT_EQ(refusal({"send", "--text", "x"}), "--from is required; 'prog send --help' says more");
  EXPECT_EQ(refusal({"status", "all"}), "'all' is one argument too many; 'prog status --help' says more");
  EXPECT_EQ(refusal({"send", "--text", "x", "--from"}), "--from needs a value: Node that sends");
  EXPECT_EQ(refusal({"send", "--text", "x", "--from", "a", "--from", "b"}), "--from is given more than once");
  EXPECT_THAT(refusal({"send", "--from", "a"}), HasSubstr("[--text,--size]"));
  EXPECT_EQ(refusal({"send", "--text", "x", "--", "all"}),
            "'all' is one argument too many; 'prog send --help' says more");
}

TEST_F(Program, RefusesAValueWithWhatIsAllowedAndNoInternalNames) {
  const std::string said = refusal({"send", "--text", "x", "--from", "a", "--count", "10"});
  EXPECT_EQ(said, "--count: '10' is not a whole number, 1 to 9");
}

TEST_F(Program, HelpIsAWordToo) {
  EXPECT_THAT(read(app, {"help"}).value(), AllOf(HasSubstr("status"), HasSubstr("--version")));
  EXPECT_THAT(read(app, {"help", "send"}).value(), AllOf(HasSubstr("--from"), HasSubstr("(required)")));
  EXPECT_THAT(read(app, {"--help"}).value(), Not(HasSubstr("UINT")));
}

TEST_F(Program, SaysItsVersion) {
  for (const char* word : {"--version", "version"})
    EXPECT_EQ(read(app, {word}), "prog " + std::string(version()) + "\n");
}

TEST_F(Program, GoesOnIfItsArgumentsAreRight) {
  EXPECT_EQ(read(app, {"send", "--from", "a", "--text", "x", "--count", "0.5e1"}), std::nullopt);
  EXPECT_EQ(count, 5u);
}

}  // namespace
}  // namespace limb_ring::cli
