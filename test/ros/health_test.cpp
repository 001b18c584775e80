#include <gmock/gmock.h>

#include "ros/small_robot.h"
#include "ros_bridge/conversions.h"
#include "ros_bridge/diagnostics_out.h"
#include "ros_bridge/health.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using Level = diagnostic_msgs::DiagnosticStatus;
using Status = diagnostic_updater::DiagnosticStatusWrapper;

/// The line from the knee (7) to the hip (3), and the knee itself.
class Health : public ::testing::Test {
 protected:
  Health() {
    status.connected = true;
    for (const auto& config : ring.nodes) {
      NodeStatus one;
      one.id = config.id;
      one.name = config.name;
      one.state = "up";
      one.pid = 100 + config.id;
      one.cpu_state = "running";
      one.cpu_boots = 1;
      one.input_state = one.output_state = "up";
      one.broken_before = one.broken_behind = -1;
      one.counter_names = {"crc_errors", "ended_lost"};
      one.counter_values = {4, 7};
      status.nodes.push_back(one);
    }
    knee().output_to = 3;
    hip().input_from = 7;
  }
  NodeStatus& knee() { return status.nodes.at(1); }
  NodeStatus& hip() { return status.nodes.at(2); }

  NodeStatus unheard() const { return unheard_node(ring.nodes.at(1)); }

  void take() {
    node.take(status, now);
    line.take(status, now);
  }
  Status of_node() {
    Status out;
    node.tell(out, now);
    return out;
  }
  /// Of what has just grown, until kWarnFor is over without more.
  void expect_warning_for_a_while(const std::string& message) {
    take();
    EXPECT_EQ(of_node().level, Level::WARN);
    EXPECT_EQ(of_node().message, message);
    take();
    now += kWarnFor + 1ns;
    EXPECT_EQ(of_node().level, Level::OK);
  }
  Status of_ring() const {
    Status out;
    tell_ring(status, out);
    return out;
  }
  Status of_line() {
    Status out;
    line.tell(out, now);
    return out;
  }

  const config::RingConfig ring = small_robot();
  RingStatus status;
  std::chrono::steady_clock::time_point now{1h};
  NodeHealth node{ring.nodes.at(1), 100ms};
  LineHealth line{ring.nodes.at(1), ring.nodes.at(2)};
};

TEST_F(Health, IsOkIfNothingIsWrongWhateverWasCountedBefore) {
  take();
  EXPECT_EQ(of_node().level, Level::OK);
  EXPECT_EQ(of_line().level, Level::OK);
}

TEST_F(Health, WarnsOfWhatIsWrongWithTheFirmwareOfTheCpu) {
  knee().problem = "its CPU runs and sends no readings of shin; step() takes longer than what it steps over";
  take();
  EXPECT_EQ(of_node().level, Level::WARN);
  EXPECT_EQ(of_node().message, knee().problem);
}

TEST_F(Health, OfTheRingIsSaidAsRingctlStatusSaysIt) {
  EXPECT_EQ(of_ring().level, Level::OK);
  EXPECT_EQ(of_ring().message, "3 of 3 nodes up");
  for (NodeStatus& one : status.nodes) one.state = "open_chain";
  hip().broken_before = 7;
  hip().broken_behind = 3;
  EXPECT_EQ(of_ring().level, Level::WARN);
  EXPECT_EQ(of_ring().message, "3 of 3 nodes work, open chain: line knee -> hip broken");
  for (NodeStatus& one : status.nodes) {
    one.state = "folded";
    one.ring_size = 3;
  }
  EXPECT_EQ(of_ring().level, Level::WARN);
  EXPECT_EQ(of_ring().message, "3 of 3 nodes up, folded back around a break");
  hip().ring_size = 1;
  EXPECT_EQ(of_ring().message, "3 of 3 nodes up, folded back in parts");
}

TEST_F(Health, OfTheRingWarnsOfANodeThatIsDownAndOfAStop) {
  knee() = unheard();
  EXPECT_EQ(of_ring().level, Level::WARN);
  EXPECT_EQ(of_ring().message, "2 of 3 nodes up");
  hip().stopped = true;
  EXPECT_EQ(of_ring().message, "2 of 3 nodes up; 1 stopped until `resume`");
  status.connected = false;
  status.message = "the daemon is gone";
  EXPECT_EQ(of_ring().level, Level::ERROR);
}

TEST_F(Health, OfTheRingIsSaidForPeopleIfSomethingIsWrong) {
  EXPECT_EQ(what_is_wrong(status.nodes), "");
  hip().cpu_state = "silent";
  EXPECT_EQ(what_is_wrong(status.nodes), "CPU of hip silent");
  hip().stopped = true;
  EXPECT_EQ(what_is_wrong(status.nodes), "CPU of hip silent; 1 stopped until `resume`");
  knee() = unheard();
  EXPECT_EQ(what_is_wrong(status.nodes), "2 of 3 nodes up; CPU of hip silent; 1 stopped until `resume`");
}

TEST_F(Health, IsStaleForANodeNobodyHasHeardAndAnErrorForOneThatIsGone) {
  const NodeStatus well = knee();
  knee() = unheard();
  take();
  EXPECT_EQ(of_node().level, Level::STALE);
  knee() = well;
  take();
  knee() = unheard();
  now += 3s;
  take();
  EXPECT_EQ(of_node().level, Level::ERROR);
  EXPECT_THAT(of_node().message, HasSubstr("not heard for 3 s"));
}

TEST_F(Health, WarnsForAWhileOfAStateThatIsOver) {
  take();
  knee().state = "open_chain";
  take();
  EXPECT_EQ(of_node().message, "open_chain");
  knee().state = "up";
  take();
  EXPECT_EQ(of_node().level, Level::WARN);
  EXPECT_EQ(of_node().message, "was open_chain");
}

TEST_F(Health, IsAnErrorForANodeThatRefusesOrIsRefused) {
  knee().refusals = {"node hip is refused by node knee: it runs another ring file: timeouts differ"};
  take();
  EXPECT_EQ(of_node().level, Level::ERROR);
  EXPECT_THAT(of_node().message, HasSubstr("it runs another ring file: timeouts differ"));
  knee().refusals.clear();
  take();
  EXPECT_EQ(of_node().level, Level::OK);
}

TEST_F(Health, IsAnErrorForANodeOfAnotherHostWhoseBeaconsAreOld) {
  knee().pid = 0;
  knee().beacon_age = 0.1;
  take();
  EXPECT_EQ(of_node().level, Level::OK);
  knee().beacon_age = 0.6;
  take();
  EXPECT_EQ(of_node().level, Level::ERROR);
}

TEST_F(Health, IsStaleNotAnErrorIfThereIsNobodyToAsk) {
  take();
  status.connected = false;
  knee() = unheard();
  take();
  EXPECT_EQ(of_node().level, Level::STALE);
  EXPECT_THAT(of_node().message, HasSubstr("nobody to ask"));
}

TEST_F(Health, IsAnErrorForAHungCpu) {
  knee().cpu_state = "silent";
  take();
  EXPECT_EQ(of_node().level, Level::ERROR);
  EXPECT_THAT(of_node().message, HasSubstr("CPU hangs"));
  EXPECT_EQ(of_line().level, Level::OK);
}

TEST_F(Health, WarnsIfTheRingCouldNotFoldBack) {
  knee().second_input_state = "down";
  take();
  EXPECT_EQ(of_node().level, Level::WARN);
  EXPECT_THAT(of_node().message, HasSubstr("can fold back only around the line out of it"));
  knee().second_input_state = "up";
  take();
  EXPECT_EQ(of_node().level, Level::OK);
}

TEST_F(Health, WarnsOfALossForFiveSeconds) {
  take();
  knee().counter_values = {4, 9};
  take();
  EXPECT_EQ(of_node().level, Level::WARN);
  EXPECT_THAT(of_node().message, HasSubstr("ended_lost +2"));
  now += 5s;
  take();
  EXPECT_EQ(of_node().level, Level::WARN);
  now += 1ms;
  EXPECT_EQ(of_node().level, Level::OK);
}

TEST_F(Health, WarnsOfANewBootAndOfANewDaemonWhoseCountersBeginAtZero) {
  take();
  knee().cpu_boots = 2;
  take();
  EXPECT_THAT(of_node().message, HasSubstr("boot 2"));
  knee().pid = 999;
  knee().counter_values = {0, 1};
  take();
  EXPECT_THAT(of_node().message, HasSubstr("daemon was restarted"));
  EXPECT_THAT(of_node().message, HasSubstr("ended_lost +1"));
}

TEST_F(Health, WarnsOfCommandsThatTheCpuDoesNotObey) {
  take();
  knee().commands_not_obeyed = 4;
  expect_warning_for_a_while("commands not obeyed +4");
}

TEST_F(Health, WarnsOfJointStatesThatAreMissing) {
  take();
  knee().states_missing = 3;
  expect_warning_for_a_while("joint states missing +3");
}

TEST_F(Health, OfTheRingWarnsOfEachLossOfTheBridgeThatHasGrown) {
  Counters counters;
  BridgeLosses losses;
  const auto told = [&] {
    losses.take(counters.losses(), now);
    Status out = of_ring();
    losses.tell(out, now);
    return out;
  };
  counters.add("states_in", 9);
  counters.set_lost("topics_corrupt", 0);
  EXPECT_EQ(told().level, Level::OK);
  counters.lose("commands_refused");
  told();
  counters.lose("commands_refused", 2);
  counters.set_lost("topics_corrupt", 1);
  EXPECT_EQ(told().level, Level::WARN);
  EXPECT_EQ(told().message, "3 of 3 nodes up; lately lost by the bridge: commands_refused +2, topics_corrupt +1");
  status.connected = false;
  EXPECT_EQ(told().level, Level::ERROR);
  status.connected = true;
  now += kWarnFor + 1ns;
  EXPECT_EQ(told().level, Level::OK);
}

TEST_F(Health, OfALineCountsWhatItsEndReceived) {
  take();
  hip().counter_values = {6, 7};
  take();
  EXPECT_EQ(of_line().level, Level::WARN);
  EXPECT_THAT(of_line().message, HasSubstr("crc_errors +2"));
  EXPECT_EQ(of_node().level, Level::OK);
}

TEST_F(Health, OfABrokenLineIsAnErrorAndThenAWarning) {
  hip().broken_before = 7;
  hip().broken_behind = 3;
  take();
  EXPECT_EQ(of_line().level, Level::ERROR);
  hip().broken_before = hip().broken_behind = -1;
  now += 1s;
  take();
  EXPECT_EQ(of_line().level, Level::WARN);
  EXPECT_THAT(of_line().message, HasSubstr("was broken"));
}

TEST_F(Health, OfALineWarnsOfABypass) {
  hip().input_from = 0;
  take();
  EXPECT_EQ(of_line().level, Level::WARN);
  EXPECT_THAT(of_line().message, HasSubstr("hip hears node 0"));
}

TEST_F(Health, OfALineIsStaleIfNeitherEndIsKnown) {
  knee() = unheard();
  hip() = unheard_node(ring.nodes.at(2));
  take();
  EXPECT_EQ(of_line().level, Level::STALE);
}

}  // namespace
}  // namespace limb_ring::bridge
