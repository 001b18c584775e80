// The one client that is the node's CPU.
#include <unistd.h>

#include "node/host_fixture.h"
#include "node/raw_client.h"
#include "support/thrown.h"

namespace limb_ring {
namespace {

using test::HostTest;
using test::kGuard;
using test::milliseconds;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class Cpu : public HostTest {
 protected:
  /// Gives as many packets as the CPU has room for. @return how many
  unsigned give_all(std::uint8_t priority) {
    unsigned given = 0;
    for (; server->cpu_can_take(); ++given) {
      give(Packet{1, 3, priority, 0, {static_cast<std::uint8_t>(given)}});
    }
    return given;
  }
};

TEST_F(Cpu, IsIntroducedToTheHandlerWithItsRealPid) {
  ConnectOptions options = options_for(Role::cpu);
  options.restarted_by_owner = true;
  options.alive_period = milliseconds{250};
  const HostPort port = connect(options);
  const host::ClientInfo& info = handler.attached.at(0);
  EXPECT_EQ(info.role, Role::cpu);
  EXPECT_EQ(info.pid, getpid());
  EXPECT_TRUE(info.restarted_by_owner);
  EXPECT_EQ(info.alive_period, milliseconds{250});
  ASSERT_NE(server->cpu(), nullptr);
  EXPECT_EQ(server->cpu()->id, info.id);
}

TEST_F(Cpu, CanTakeNothingIfThereIsNone) {
  EXPECT_FALSE(server->cpu_can_take());
  EXPECT_EQ(server->cpu(), nullptr);
  const HostPort port = tool();
  EXPECT_FALSE(server->cpu_can_take());
  EXPECT_FALSE(server->interrupt({}));
  EXPECT_EQ(server->counters().interrupts_lost, 1u);
}

TEST_F(Cpu, GetsThePacketAsItWas) {
  HostPort port = cpu();
  give(Packet{1, kBroadcast, 2, 63, {0xFB, 0, 0xFD}});
  const auto packet = next<Packet>(port);
  EXPECT_EQ(packet.source, 1);
  EXPECT_EQ(packet.destination, kBroadcast);
  EXPECT_EQ(packet.priority, 2);
  EXPECT_EQ(packet.channel, 63);
  EXPECT_THAT(packet.data, ElementsAre(0xFB, 0, 0xFD));
}

TEST_F(Cpu, HasRoomForAWindowOfPacketsUntilItReceives) {
  HostPort port = cpu();
  EXPECT_EQ(give_all(2), 8u);
  EXPECT_FALSE(server->cpu_can_take());
  const unsigned credits = handler.credits;
  for (int i = 0; i < 4; ++i) next<Packet>(port);
  until([&] { return server->cpu_can_take(); });
  EXPECT_EQ(handler.credits, credits + 1);
  EXPECT_EQ(give_all(2), 4u);
}

class PatientCpu : public Cpu {
 protected:
  PatientCpu() : port(connect_patient()) {
    until([this] { return server->cpu_can_take(); });
  }
  HostPort connect_patient() {
    ConnectOptions options = options_for(Role::cpu);
    options.results_may_wait = true;
    return connect(options);
  }
  /// A send of it ends. @return whether the result has gone out in the loop's next turn
  bool result_comes_at_once() {
    const std::size_t before = handler.sends.size();
    const std::uint32_t token = port.send(1, {0xFB});
    until([&] { return handler.sends.size() > before; });
    server->result(server->cpu()->id, {token, Outcome::delivered, milliseconds{1}, 1, "", Reason::none});
    io.restart();
    io.poll();
    return port.receive(milliseconds{0}).has_value();
  }

  HostPort port;
};

TEST_F(PatientCpu, GetsAResultWithTheNextPacket) {
  // If this process was not scheduled for 20 ms in between, it is out of time already.
  for (int tries = 0; result_comes_at_once(); ++tries) ASSERT_LT(tries, 20);
  give(Packet{1, 3, 2, 0, {0xFC}});
  EXPECT_EQ(next<Result>(port).outcome, Outcome::delivered);
  EXPECT_EQ(next<Packet>(port).data.at(0), 0xFC);
}

TEST_F(PatientCpu, GetsAResultEvenIfNothingElseComes) {
  if (result_comes_at_once()) return;
  EXPECT_EQ(next<Result>(port).outcome, Outcome::delivered);
}

TEST_F(PatientCpu, GetsACapturedPacketNoLaterThanAnybodyBecauseAResultWaits) {
  HostPort other = tool();
  // If this process was not scheduled for 20 ms in between, the result is out of time already.
  for (int tries = 0; result_comes_at_once(); ++tries) ASSERT_LT(tries, 20);
  const std::vector<std::uint8_t> bytes(24, 7);
  client::CapturedView packet;
  packet.packet.bytes = {bytes.data(), bytes.size()};
  server->captured(server->cpu()->id, packet);
  server->captured(handler.attached.back().id, packet);
  next<CapturedPacket>(other);
  ASSERT_TRUE(std::holds_alternative<Result>(port.receive(milliseconds{0}).value()));
  EXPECT_TRUE(port.receive(milliseconds{0}).has_value()) << "it was given the packet before the other was";
}

TEST_F(Cpu, GivesCreditWithWhatItSends) {
  HostPort port = cpu();
  const unsigned given = give_all(2);
  next<Packet>(port);
  EXPECT_FALSE(server->cpu_can_take());
  port.send(1, {0xFB});
  until([&] { return server->cpu_can_take(); });
  EXPECT_EQ(given, 8u);
}

TEST_F(Cpu, GetsAnyNumberOfPacketsWhenItReceivesOnCredit) {
  HostPort port = cpu();
  unsigned given = give_all(2);
  handler.when_credit = [&] {
    for (; server->cpu_can_take() && given < 200; ++given) {
      give(Packet{1, 3, 2, 0, {static_cast<std::uint8_t>(given)}});
    }
  };
  for (unsigned i = 0; i < 200; ++i) ASSERT_EQ(next<Packet>(port).data.at(0), i);
  EXPECT_EQ(given, 200u);
}

TEST_F(Cpu, GetsInterruptsFirstAndPacketsByPriority) {
  HostPort port = cpu();
  handler.when_asked = [&](const auto& call) { server->reply(call.client, call.token, "{}"); };
  for (const std::uint8_t priority : {3, 1, 0, 1}) {
    give(Packet{1, 3, priority, 0, {priority}});
  }
  EXPECT_TRUE(server->interrupt({Interrupt::Action::stop, 9, 1}));
  during([&] { return port.ask("{}", kGuard); });  // its reply comes behind all those
  const auto interrupt = next<Interrupt>(port);
  EXPECT_EQ(interrupt.action, Interrupt::Action::stop);
  EXPECT_EQ(interrupt.source, 9);
  EXPECT_EQ(interrupt.factor, 1);
  for (const int priority : {0, 1, 1, 3}) EXPECT_EQ(next<Packet>(port).priority, priority);
}

TEST_F(Cpu, OnlyOneMayAttach) {
  HostPort port = cpu();
  const std::string reason = test::thrown<HostPortError>([&] { connect(options_for(Role::cpu)); });
  EXPECT_THAT(reason,
              AllOf(HasSubstr("node 3 (left_knee) has a CPU already"), HasSubstr("pid " + std::to_string(getpid()))));
  EXPECT_EQ(server->counters().refused, 1u);
  EXPECT_TRUE(server->cpu_can_take());
}

TEST_F(Cpu, MayComeAgainWhenTheOldOneIsGone) {
  for (int i = 0; i < 20; ++i) {
    HostPort port = cpu();
    EXPECT_TRUE(server->cpu_can_take());
  }
  until([&] { return handler.detached.size() == 20; });
  EXPECT_EQ(server->cpu(), nullptr);
  EXPECT_EQ(server->counters().refused, 0u);
}

TEST_F(Cpu, IsRefusedWithTheHandlersReason) {
  handler.objection = "this node has cpu: none";
  EXPECT_THAT(test::thrown<HostPortError>([&] { connect(options_for(Role::cpu)); }),
              HasSubstr("this node has cpu: none"));
  EXPECT_EQ(server->cpu(), nullptr);
  EXPECT_TRUE(handler.detached.empty());
}

TEST_F(Cpu, IsToldTheReasonWhenItIsDisconnected) {
  HostPort port = cpu();
  const std::uint32_t token = port.send(1, {1});
  until([&] { return !handler.sends.empty(); });
  server->disconnect(handler.sends.front().client, "reset by node 0");
  EXPECT_TRUE(handler.detached.empty()) << "told from inside the call";
  EXPECT_EQ(server->cpu(), nullptr);
  const auto result = next<Result>(port);
  EXPECT_EQ(result.token, token);
  EXPECT_EQ(result.outcome, Outcome::cancelled);
  EXPECT_EQ(next<Disconnected>(port).reason, "reset by node 0");
  until([&] { return handler.detached.size() == 1; });
}

TEST_F(Cpu, CannotClaimMoreRoomThanIsSensible) {
  test::RawClient client("r", "3");
  client::Greeting greeting;
  greeting.role = Role::cpu;
  client.say(greeting);
  for (int i = 0; i < 10; ++i) client.say(client::Credit{0xFFFF});
  until([&] { return handler.alive == 10; });
  EXPECT_EQ(give_all(0), 64u);
}

TEST_F(Cpu, IsTheOnlyOneThatGivesCredit) {
  test::RawClient client("r", "3");
  client.say(client::Greeting{});
  client.say(client::Credit{8});
  until([&] { return handler.alive == 1; });
  EXPECT_FALSE(server->cpu_can_take());
  EXPECT_EQ(handler.credits, 0u);
}

}  // namespace
}  // namespace limb_ring
