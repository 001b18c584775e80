// What `ring_sim plan` prints and ends with.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "support/own_folder.h"
#include "tools/ring_sim/command_line.h"
#include "tools/ring_sim/run_ring_sim.h"

namespace limb_ring::ring_sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class PlanCommand : public test::OwnFolder {
 protected:
  static CliRun plan(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "plan");
    return ring_sim(arguments);
  }

  /// Two nodes, and a stream of this size and rate from the first to the second.
  std::string two_nodes(const std::string& size_and_rate) {
    return write("two.yaml",
                 "ring: two\nnodes: [{id: 9, name: head}, {id: 4, name: body}]\n"
                 "traffic: [{name: camera, from: head, to: body, " +
                     size_and_rate + "}]\n");
  }
};

TEST_F(PlanCommand, SaysWhatIsAssumedAndThatTheRingCarriesIt) {
  const CliRun said = plan({two_nodes("size: 61440, rate: 30")});
  EXPECT_EQ(said.code, kDone);
  EXPECT_THAT(said.out, AllOf(HasSubstr("camera"), HasSubstr("beacons of 2 nodes"), HasSubstr("The ring carries this."),
                              HasSubstr("Assumed for lines without a rate: 1Gbit/s, relay delay 512ns.")));
}

TEST_F(PlanCommand, SaysWhyTheRingDoesNotCarryIt) {
  const CliRun said = plan({two_nodes("size: 61440, rate: 300"), "--rate", "100Mbit/s"});
  EXPECT_EQ(said.code, kBroken);
  EXPECT_THAT(said.out, AllOf(HasSubstr("cannot be relied on to carry this"), HasSubstr("node head would need"),
                              HasSubstr("100Mbit/s")));
}

TEST_F(PlanCommand, CallsAStreamLateIfItMayMissItsDeadline) {
  const CliRun said = plan({two_nodes("size: 61440, rate: 30, deadline: 500us")});
  EXPECT_EQ(said.code, kBroken);
  EXPECT_THAT(said.out,
              AllOf(HasSubstr("  500"), HasSubstr("late"), HasSubstr("'camera' is late: delivered after up to "),
                    HasSubstr(", and its deadline is 500.000 us")));
  EXPECT_EQ(plan({two_nodes("size: 61440, rate: 30, deadline: 33ms")}).code, kDone);
}

TEST_F(PlanCommand, FitsInto80ColumnsWhateverTheNames) {
  const std::string file =
      write("long.yaml",
            "ring: two\nnodes: [{id: 9, name: head_with_a_name_of_32_characters}, {id: 4, name: body}]\n"
            "traffic: [{name: a_camera_of_which_the_name_is_long_too, from: 9, to: body, size: "
            "30000000, rate: 0.001, deadline: 1000s}]\n");
  for (const CliRun& said : {plan({file}), plan({file, "--simulate", "10ms"})}) {
    std::istringstream lines(said.out);
    for (std::string line; std::getline(lines, line) && !line.empty();) EXPECT_LE(line.size(), 80u) << line;
  }
}

TEST_F(PlanCommand, ShowsMeasuredLatenciesBesideTheBounds) {
  const std::string file = two_nodes("size: 61440, rate: 30");
  const CliRun said = plan({file, "--simulate", "100ms", "--seed", "7"});
  EXPECT_EQ(said.code, kDone);
  EXPECT_THAT(said.out, AllOf(HasSubstr("measured"), HasSubstr("Simulated 100ms with seed 7"),
                              HasSubstr("Every message that has a bound came within it.")));
  EXPECT_EQ(plan({file, "--simulate", "100ms", "--seed", "7"}).out, said.out);
  EXPECT_THAT(plan({file, "--simulate"}).out, HasSubstr("Simulated 1s with seed 1"));
}

TEST_F(PlanCommand, RefusesASeedIfNothingIsRandom) {
  const std::string file = two_nodes("size: 61440, rate: 30");
  const CliRun said = plan({file, "--seed", "7"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_EQ(said.out, "");
  EXPECT_THAT(said.errors, HasSubstr("--seed goes with --simulate"));
}

TEST_F(PlanCommand, PrintsJsonAndCsvForPrograms) {
  const std::string file = two_nodes("size: 500, rate: 30, phase: 1ms");
  const auto json = nlohmann::json::parse(plan({file, "--json", "--simulate", "100ms"}).out);
  EXPECT_EQ(json["carried"], true);
  EXPECT_EQ(json["kept"], true);
  EXPECT_EQ(json["nodes"].size(), 2u);
  EXPECT_EQ(json["streams"][0]["stream"], "camera");
  EXPECT_EQ(json["streams"][0]["from"], "head");
  // 512 bytes on the line at 8 ns, two relay delays of 512 ns.
  EXPECT_DOUBLE_EQ(json["streams"][0]["confirmed_max_us"], 5.12);
  EXPECT_THAT(plan({file, "--csv"}).out, StartsWith("stream,from,to,priority,bytes,packets,"));
}

TEST_F(PlanCommand, TakesTheNameOfARing) {
  const std::string users = folder + "/limb_ring";
  std::filesystem::create_directory(users);
  std::filesystem::rename(two_nodes("size: 1, rate: 1"), users + "/mine.yaml");
  ::setenv("XDG_CONFIG_HOME", folder.c_str(), 1);
  EXPECT_EQ(plan({"mine"}).code, kDone);
  const CliRun unknown = plan({"mine9"});
  ::unsetenv("XDG_CONFIG_HOME");
  EXPECT_EQ(unknown.code, kUsage);
  EXPECT_THAT(unknown.errors, HasSubstr("there is no file mine9, and no ring mine9.yaml in " + users));
}

TEST_F(PlanCommand, RefusesWrongFilesAndArguments) {
  const CliRun absent = plan({"/nowhere.yaml"});
  EXPECT_EQ(absent.code, kUsage);
  EXPECT_THAT(absent.errors, HasSubstr("there is no such file"));
  const CliRun wrong = plan({two_nodes("rate: 30")});
  EXPECT_EQ(wrong.code, kUsage);
  EXPECT_THAT(wrong.errors, HasSubstr("two.yaml:3:11: entry 'traffic[0]'"));
  EXPECT_EQ(plan({}).code, kUsage);
  const CliRun time = plan({two_nodes("size: 1, rate: 1"), "--simulate", "5"});
  EXPECT_EQ(time.code, kUsage);
  EXPECT_THAT(time.errors, HasSubstr("with its unit"));
}

}  // namespace
}  // namespace limb_ring::ring_sim
