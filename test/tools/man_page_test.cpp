// The man page that a program writes of itself.
#include "tools/common/man_page.h"

#include <gmock/gmock.h>

#include "tools/common/command_line.h"

namespace limb_ring::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct Tool {
  Tool() {
    app.footer("'tool help SUBCOMMAND' explains one.\nExit code: 0 done; 1 not.");
    app.add_option("--ring", ring, "Name of the ring");
    CLI::App* send = app.add_subcommand("send", "Send packets");
    send->footer("Exit code: 0 done; 1 not.");
    send->add_option("TO", to, "Node to send to")->required();
    CLI::App* data = send->add_option_group("data", "What to send");
    data->add_option("--text", text, ".starts with a dot, and 'quotes' \\ too");
    app.add_subcommand("fault", "Break it")->add_subcommand("cut", "A line");
  }

  std::string page() { return read(app, {"man-page"}).value_or("nothing"); }

  CLI::App app{"Sends packets. And more than that.", "tool"};
  std::string ring, to, text;
};

TEST(ManPage, NamesEverySubcommandAndOptionUnderTheHeadingsOfAManPage) {
  Tool tool;
  EXPECT_THAT(tool.page(), AllOf(HasSubstr(".TH TOOL 1"), HasSubstr("tool \\- sends packets\n"),
                                 HasSubstr(".SH OPTIONS"), HasSubstr("\\fB\\-\\-ring\\fR TEXT\nName of the ring"),
                                 HasSubstr(".SS tool send [OPTIONS] TO\nSend packets"), HasSubstr("\\fBTO\\fR"),
                                 HasSubstr(".SS tool fault [OPTIONS] SUBCOMMAND ..."),
                                 HasSubstr(".SS tool fault cut [OPTIONS]\nA line"), HasSubstr(".SH SEE ALSO")));
}

TEST(ManPage, ListsTheExitCodesOnceInTheirOwnSection) {
  Tool tool;
  const std::string page = tool.page();
  EXPECT_THAT(page, HasSubstr(".SH EXIT STATUS\n0 done; 1 not."));
  EXPECT_EQ(page.find("0 done"), page.rfind("0 done"));
  EXPECT_THAT(page, HasSubstr(".PP\n\\(aqtool help SUBCOMMAND\\(aq explains one.\n"));
}

TEST(ManPage, EscapesTextThatRoffWouldInterpret) {
  Tool tool;
  EXPECT_THAT(tool.page(), HasSubstr("\n\\&.starts with a dot, and \\(aqquotes\\(aq \\e too\n"));
}

TEST(ManPage, OfATextKeepsItsLines) {
  const std::string page = man_page_of_text(
      "node", "node: the CPU. More.\nUsage: node\n  --again  twice\nExit codes: 0 ended.\n", "[OPTIONS]");
  EXPECT_THAT(page, AllOf(HasSubstr("node \\- the CPU\n"),
                          HasSubstr(".nf\nnode: the CPU. More.\nUsage: node\n  \\-\\-again  twice\n.fi"),
                          HasSubstr(".SH EXIT STATUS\n0 ended.\n"), Not(HasSubstr("Exit codes"))));
}

}  // namespace
}  // namespace limb_ring::cli
