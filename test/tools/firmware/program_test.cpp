// The program itself, as a child of this test, at a host port whose daemon is this test.
#include <algorithm>
#include <fstream>

#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"
#include "node/host_fixture.h"
#include "tools/firmware/child.h"

namespace limb_ring::test {
namespace {

using testing::HasSubstr;

std::int64_t wall_ns() { return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count(); }

class ProgramTest : public HostTest {
 protected:
  ProgramTest() {
    handler.when_asked = [this](const FakeHandler::Call& call) {
      if (call.data.find("\"setup\"") == std::string::npos) return;
      server->reply(call.client, call.token, setup());
    };
    handler.when_sent = [this](const FakeHandler::Call& call) {
      Result delivered;
      delivered.token = call.token;
      delivered.outcome = Outcome::delivered;
      server->result(call.client, delivered);
      if (const auto state = decode(call)) last = *state;
    };
  }

  std::string setup() const {
    return R"({"id": 3, "name": "left_knee", "sensors": [], "bandwidth": 8, "damping": 0.9, "command_timeout_ms": 200,
      "alive_period_ms": 0, "state_to": 0, "joints": [{"name": "l_knee", "slides": false, "lower": -3.14,
      "upper": 3.14, "velocity": 6, "effort": 50, "initial": 0, "damps": false}], "state_rate": )" +
           std::to_string(state_rate) + "}";
  }
  void launch(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {LIMB_FIRMWARE, "--node", "left_knee"});
    child = std::make_unique<Child>(std::move(arguments), folder.path() + "/stderr");
  }
  void start(std::vector<std::string> arguments = {}) {
    launch(std::move(arguments));
    until([this] { return server->cpu_can_take(); });
  }
  void until_ended() {
    until([this] { return child->ended(); });
  }
  void give(std::uint8_t channel, const std::vector<std::uint8_t>& data) {
    Packet packet;
    packet.channel = channel;
    packet.data = data;
    HostTest::give(packet);
  }
  void give(std::uint8_t channel, const std::string& text) {
    give(channel, std::vector<std::uint8_t>(text.begin(), text.end()));
  }
  static payload::JointCommand move_to(double position, std::int64_t stamp_ns) {
    payload::JointCommand command;
    command.stamp_ns = stamp_ns;
    command.valid_for_us = 30'000'000;
    command.joints.resize(1);
    command.joints[0].position = position;
    return command;
  }
  static std::optional<payload::JointState> decode(const FakeHandler::Call& call) {
    const auto state =
        payload::decode_joint_state({reinterpret_cast<const std::uint8_t*>(call.data.data()), call.data.size()});
    return state ? std::optional(*state) : std::nullopt;
  }

  int state_rate = 100;
  std::optional<payload::JointState> last;  ///< the last state sent
  std::unique_ptr<Child> child;
};

TEST_F(ProgramTest, IsTheNodesCpuAndPromisesToBeHeard) {
  start();
  ASSERT_NE(server->cpu(), nullptr);
  EXPECT_EQ(server->cpu()->pid, child->pid());
  EXPECT_GT(server->cpu()->alive_period.count(), 0);
}

TEST_F(ProgramTest, SendsItsStatesToTheBodyAtTheHighestPriorityInOrder) {
  start();
  until([this] { return handler.sends.size() >= 20; });
  for (std::uint16_t i = 0; i < 20; ++i) {
    const auto& sent = handler.sends[i];
    EXPECT_EQ(sent.destination, 0);
    EXPECT_EQ(sent.priority, 0);
    EXPECT_EQ(sent.channel, 2);
    ASSERT_TRUE(decode(sent));
    EXPECT_EQ(decode(sent)->sequence, i);
    EXPECT_TRUE(decode(sent)->mode.safe);
  }
}

// A wake-up for each command would double what a CPU costs at 1 kHz.
TEST_F(ProgramTest, TakesACommandWithItsNextSampleIfThatIsDueSoon) {
  state_rate = 1000;
  start();
  const auto sent = handler.when_sent;
  handler.when_sent = [this, sent](const FakeHandler::Call& call) {
    sent(call);
    if (server->cpu_can_take()) give(2, *encode(move_to(0.5, wall_ns())));
  };
  until([this] { return last && last->mode.commanded; });
  const std::uint64_t waits = child->waits();
  const std::size_t states = handler.sends.size();
  until([this, states] { return handler.sends.size() >= states + 200; });
  EXPECT_LT(child->waits() - waits, (handler.sends.size() - states) * 3 / 2);
}

TEST_F(ProgramTest, MovesOnCommandAndGoesSafeWithoutOne) {
  start();
  until([this] {
    if (server->cpu_can_take()) give(2, *encode(move_to(0.5, wall_ns())));
    return last && last->mode.commanded && last->joints[0].position > 0.1;
  });
  until([this] { return !last->mode.commanded && last->mode.safe && last->mode.hold; });
}

TEST_F(ProgramTest, RefusesAStaleCommandAndSaysSoInItsState) {
  start();
  constexpr std::int64_t kHour = 3'600'000'000'000;
  give(2, *encode(move_to(0.5, wall_ns() - kHour)));
  until([this] { return last && last->refused == 1; });
  EXPECT_EQ(last->joints[0].position, 0);
  EXPECT_EQ(std::count_if(handler.sends.begin(), handler.sends.end(),
                          [](const auto& sent) {
                            const auto state = decode(sent);
                            return state && state->mode.command_refused;
                          }),
            1);
}

TEST_F(ProgramTest, ShowsAStopInItsStateAndTellsTheDaemon) {
  start();
  Interrupt stop;
  stop.action = Interrupt::Action::stop;
  ASSERT_TRUE(server->interrupt(stop));
  until([this] { return last && last->mode.stopped; });
  EXPECT_EQ(handler.requests.back().data, R"({"do": "stop_latched", "latched": true})");
}

TEST_F(ProgramTest, EndsWithTheCodeItIsTold) {
  start();
  give(0, "exit 7");
  until_ended();
  EXPECT_EQ(child->code(), 7);
  EXPECT_THAT(child->said(), HasSubstr("ends on purpose with code 7"));
}

TEST_F(ProgramTest, HangsWhenToldAndThenNotEvenSigtermEndsIt) {
  start();
  give(0, "hang");
  until([this] { return child->said().find("hangs on purpose") != std::string::npos; });
  child->kill(SIGTERM);
  until([this] { return child->leaves_pending(SIGTERM); });
  EXPECT_FALSE(child->ended());
}

TEST_F(ProgramTest, HangsAfterTheTimeGiven) {
  start({"--hang-after", "0.05"});
  until([this] { return child->said().find("hangs on purpose") != std::string::npos; });
}

TEST_F(ProgramTest, LogsEachCommandThatItObeys) {
  const std::string log = folder.path() + "/commands";
  start({"--command-log", log});
  const std::int64_t stamp = wall_ns();
  give(2, *encode(move_to(0.5, stamp)));
  give(2, *encode(move_to(0.5, stamp - 60'000'000'000)));  // too old: not obeyed
  until([this] { return last && last->refused == 1; });
  std::ifstream file(log);
  std::int64_t came = 0, sent = 0, more = 0;
  ASSERT_TRUE(file >> came >> sent);
  EXPECT_EQ(sent, stamp);
  EXPECT_GE(came, stamp);
  EXPECT_FALSE(file >> more);
}

TEST_F(ProgramTest, RefusesALogThatCannotBeWritten) {
  launch({"--command-log", folder.path() + "/no/folder/commands"});
  until_ended();
  EXPECT_EQ(child->code(), 2);
  EXPECT_THAT(child->said(), HasSubstr("--command-log: "));
}

TEST_F(ProgramTest, RefusesAnInstantOfAVirtualClockOnALiveRing) {
  launch({"--endless-loop-at", "20s"});
  until_ended();
  EXPECT_EQ(child->code(), 2);
  EXPECT_THAT(child->said(), HasSubstr("ringctl up --clock virtual"));
}

TEST_F(ProgramTest, EndsCleanlyOnSigtermAndSigint) {
  for (int signal : {SIGTERM, SIGINT}) {
    handler.sends.clear();
    start();
    until([this] { return !handler.sends.empty(); });
    child->kill(signal);
    until_ended();
    EXPECT_EQ(child->code(), 0);
    EXPECT_THAT(child->said(), HasSubstr("left_knee: sent "));
    until([this] { return server->cpu() == nullptr; });
  }
}

TEST_F(ProgramTest, EndsWithAMessageWhenItsDaemonIsGone) {
  start();
  server.reset();
  until_ended();
  EXPECT_EQ(child->code(), 1);
  EXPECT_THAT(child->said(), HasSubstr("left_knee: disconnected: "));
}

}  // namespace
}  // namespace limb_ring::test
