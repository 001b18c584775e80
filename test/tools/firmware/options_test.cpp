#include "tools/firmware/options.h"

#include <cstdlib>
#include <initializer_list>
#include <vector>

#include <gmock/gmock.h>

#include "support/temporary_folder.h"

namespace limb_ring::firmware {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;
using std::chrono::nanoseconds;

/// Arguments and environment of one call; the environment is as it was afterwards.
class OptionsTest : public testing::Test {
 protected:
  void SetUp() override {
    unsetenv("LIMB_RING_CONFIG");
    unsetenv("LIMB_RING_NODE");
    unsetenv("LIMB_RING_RING");
  }
  void TearDown() override { SetUp(); }

  static Options parse(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "limb_firmware");
    return parse_options(static_cast<int>(arguments.size()), arguments.data());
  }
  static std::string refusal(std::vector<const char*> arguments) {
    try {
      parse(std::move(arguments));
    } catch (const OptionsError& error) {
      return error.what();
    }
    return "accepted";
  }
};

TEST_F(OptionsTest, ComeFromTheCommandLine) {
  const auto options = parse({"--node=left_knee", "--ring", "r", "--hang-after", "1.5"});
  EXPECT_EQ(options.node, "left_knee");
  EXPECT_EQ(options.ring, "r");
  EXPECT_EQ(options.hang_after, nanoseconds(1500ms));
  EXPECT_EQ(parse({"--node", "1", "--hang-after", "20ms"}).hang_after, nanoseconds(20ms));
}

TEST_F(OptionsTest, PlantAnEndlessLoopAndLogCommands) {
  const auto options = parse({"--node", "1", "--endless-loop-at", "20s", "--command-log", "/tmp/commands"});
  EXPECT_EQ(options.endless_loop_at, nanoseconds(20s));
  EXPECT_EQ(options.command_log, "/tmp/commands");
  EXPECT_FALSE(parse({"--node", "1"}).endless_loop_at);
  EXPECT_THAT(refusal({"--node", "1", "--endless-loop-at", "-1"}), HasSubstr("--endless-loop-at"));
}

TEST_F(OptionsTest, ElseFromTheEnvironmentThatTheDaemonGives) {
  setenv("LIMB_RING_NODE", "12", 1);
  setenv("LIMB_RING_RING", "s", 1);
  const auto options = parse({"--node", "13"});
  EXPECT_EQ(options.node, "13");
  EXPECT_EQ(options.ring, "s");
  EXPECT_FALSE(options.hang_after);
}

TEST_F(OptionsTest, TakeTheNameOfTheRingFromItsFile) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("ring.yaml", "ring: two\nnodes: [{id: 4}, {id: 9}]\n");
  EXPECT_EQ(parse({"--config", file.c_str(), "--node", "4"}).ring, "two");
  EXPECT_EQ(parse({"--config", file.c_str(), "--node", "4", "--ring", "x"}).ring, "x");
  EXPECT_THROW(parse({"--config", "/nonexistent.yaml", "--node", "4"}), std::runtime_error);
}

TEST_F(OptionsTest, AreRefusedWithWhatWouldBeRight) {
  EXPECT_THAT(refusal({}), HasSubstr("Give --node ID or NAME, or LIMB_RING_NODE"));
  EXPECT_THAT(refusal({"--node", "1", "--hang-after", "-1"}), HasSubstr("--hang-after"));
  EXPECT_THAT(refusal({"--node", "1", "--hang-after", "nan"}), HasSubstr("--hang-after"));
  EXPECT_THAT(refusal({"--node", "1", "--hang-after", "soon"}), HasSubstr("hang-after"));
  EXPECT_EQ(refusal({"--nod3", "1"}),
            "there is no option --nod3, did you mean '--node'? 'limb_firmware --help' says more");
  EXPECT_EQ(refusal({"left_knee"}), "'left_knee' is one argument too many; 'limb_firmware --help' says more");
}

TEST_F(OptionsTest, NeedNoNodeForHelp) {
  EXPECT_THAT(parse({"--help"}).print, HasSubstr("--hang-after"));
  EXPECT_THAT(parse({"--version"}).print, HasSubstr("limb_firmware "));
}

}  // namespace
}  // namespace limb_ring::firmware
