// Clients that do not read, and the queues that are bounded all the same.
#include "node/host_fixture.h"
#include "node/raw_client.h"

namespace limb_ring {
namespace {

using test::HostTest;
using test::kGuard;
using test::milliseconds;

class SlowClient : public HostTest {};

TEST_F(SlowClient, ThatObservesIsToldHowMuchItMissed) {
  HostPort port = tool();
  const host::ClientId id = handler.attached.front().id;
  const std::string line(1000, 'x');
  unsigned said = 0;
  while (server->counters().observed_lost < 100) {
    server->observed(id, line);
    ++said;
    turn();
  }
  std::uint64_t seen = 0, lost = 0;
  while (seen + lost < said) {
    const auto message = during([&] { return port.receive(kGuard); }).value();
    seen += std::holds_alternative<Observed>(message);
    if (const auto* missed = std::get_if<ObservedLost>(&message)) lost += missed->count;
  }
  EXPECT_EQ(seen + lost, said);
  EXPECT_EQ(lost, server->counters().observed_lost);
  EXPECT_TRUE(port.connected());
}

TEST_F(SlowClient, ThatCapturesLosesPacketsAndStaysConnected) {
  HostPort port = tool();
  const host::ClientId id = handler.attached.front().id;
  const std::vector<std::uint8_t> bytes(524, 7);
  client::CapturedView packet;
  packet.packet.bytes = {bytes.data(), bytes.size()};
  unsigned given = 0, lost = 0;
  while (lost < 100) {
    server->captured(id, packet) ? ++given : ++lost;
    turn();
  }
  EXPECT_EQ(server->counters().captured_lost, lost);
  server->capture_counts(id, {});
  unsigned seen = 0;
  while (std::holds_alternative<CapturedPacket>(during([&] { return port.receive(kGuard); }).value())) ++seen;
  EXPECT_EQ(seen, given);
  EXPECT_TRUE(port.connected());
}

TEST_F(SlowClient, ThatObservesStillGetsItsResults) {
  HostPort port = tool();
  const host::ClientId id = handler.attached.front().id;
  const std::uint32_t token = port.send(1, {1});
  until([&] { return !handler.sends.empty(); });
  while (server->counters().observed_lost == 0) {
    server->observed(id, std::string(1000, 'x'));
    turn();
  }
  server->result(id, {token, Outcome::delivered, {}, 1, ""});
  EXPECT_EQ(during([&] { return port.wait(token, kGuard); }).outcome, Outcome::delivered);
}

TEST_F(SlowClient, ThatNeverReadsItsResultsIsDisconnected) {
  test::RawClient client("r", "3");
  client.say(client::Greeting{});
  until([&] { return handler.attached.size() == 1; });
  const host::ClientId id = handler.attached.front().id;
  Result result;
  result.reason = std::string(10000, 'x');
  std::size_t said = 0;
  while (server->counters().slow_clients == 0 && said < 100'000'000) {
    server->result(id, result);
    said += result.reason.size();
    turn();
  }
  EXPECT_EQ(server->counters().slow_clients, 1u);
  until([&] { return handler.detached.size() == 1; });
  EXPECT_EQ(tool().id(), 3);
}

TEST_F(SlowClient, ThatOnlySendsIsServedUntilItReads) {
  HostPort port = tool();
  handler.when_sent = [&](const auto& call) {
    server->result(call.client, {call.token, Outcome::delivered, {}, 1, ""});
  };
  constexpr unsigned kSends = 20000;
  during([&] {
    for (unsigned i = 0; i < kSends; ++i) port.send(1, {1, 2, 3});
    return 0;
  });
  unsigned results = 0;
  during([&] {
    while (results < kSends && std::get<Result>(port.receive(kGuard).value()).token != 0) ++results;
    return 0;
  });
  EXPECT_EQ(results, kSends);
}

TEST_F(SlowClient, LosesItsCallsWhenTheServerCloses) {
  HostPort port = tool();
  port.send(1, {1});
  until([&] { return !handler.sends.empty(); });
  server->close();
  EXPECT_EQ(next<Result>(port).outcome, Outcome::cancelled);
  EXPECT_EQ(next<Disconnected>(port).reason, "ringd has ended");
  EXPECT_TRUE(handler.detached.empty());
}

}  // namespace
}  // namespace limb_ring
