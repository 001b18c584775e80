// What a client asks, and what comes back to it.
#include <algorithm>

#include "node/host_fixture.h"
#include "node/raw_client.h"

namespace limb_ring {
namespace {

using test::HostTest;
using test::kGuard;
using test::milliseconds;
using testing::HasSubstr;

class Calls : public HostTest {};

TEST_F(Calls, AreWelcomedWithTheNodesNames) {
  const HostPort port = tool();
  EXPECT_EQ(port.id(), 3);
  EXPECT_EQ(port.name(), "left_knee");
  EXPECT_EQ(port.ring(), "r");
}

TEST_F(Calls, SendReachesTheHandlerAndItsResultComesBack) {
  HostPort port = tool();
  const std::uint32_t token = port.send(12, {'h', 'i'}, 1, 2);
  until([&] { return !handler.sends.empty(); });
  const auto& sent = handler.sends.front();
  EXPECT_EQ(sent.token, token);
  EXPECT_EQ(sent.destination, 12);
  EXPECT_EQ(sent.priority, 1);
  EXPECT_EQ(sent.channel, 2);
  EXPECT_EQ(sent.data, "hi");
  server->result(sent.client, {token, Outcome::refused, std::chrono::nanoseconds{75264}, 2, "full"});
  const auto result = next<Result>(port);
  EXPECT_EQ(result.token, token);
  EXPECT_EQ(result.outcome, Outcome::refused);
  EXPECT_EQ(result.round_trip, std::chrono::nanoseconds{75264});
  EXPECT_EQ(result.tries, 2u);
  EXPECT_EQ(result.reason, "full");
}

TEST_F(Calls, InterruptAndPullReachTheHandler) {
  HostPort port = tool();
  const std::uint32_t interrupted = port.interrupt(kBroadcast, 7, true);
  const std::uint32_t pulled = port.pull(5);
  until([&] { return !handler.pulls.empty(); });
  EXPECT_EQ(handler.interrupts.at(0).token, interrupted);
  EXPECT_EQ(handler.interrupts.at(0).destination, kBroadcast);
  EXPECT_EQ(handler.interrupts.at(0).factor, 7);
  EXPECT_TRUE(handler.interrupts.at(0).force);
  EXPECT_EQ(handler.pulls.at(0).token, pulled);
  EXPECT_EQ(handler.pulls.at(0).factor, 5);
}

TEST_F(Calls, AskGetsTheReply) {
  HostPort port = tool();
  handler.when_asked = [&](const auto& call) {
    server->reply(call.client, call.token, "{\"asked\": " + call.data + "}");
  };
  EXPECT_EQ(during([&] { return port.ask("{\"do\": 1}", kGuard); }), "{\"asked\": {\"do\": 1}}");
}

TEST_F(Calls, AskThrowsWhatWentWrong) {
  HostPort port = tool();
  handler.when_asked = [&](const auto& call) { server->reply(call.client, call.token, "{\"error\":\"no node 99\"}"); };
  const auto ask = [&] { return port.ask("{}", kGuard); };
  EXPECT_THROW(during(ask), HostPortError);
}

TEST_F(Calls, AReplyTooLargeForTheHostPortIsAnError) {
  HostPort port = tool();
  handler.when_asked = [&](const auto& call) {
    server->reply(call.client, call.token, std::string(client::kMaxReply + 1, 'x'));
  };
  port.request("{}");
  EXPECT_THAT(next<Reply>(port).json, HasSubstr("error"));
  handler.when_asked = [&](const auto& call) {
    server->reply(call.client, call.token, std::string(client::kMaxReply, 'x'));
  };
  port.request("{}");
  EXPECT_EQ(next<Reply>(port).json.size(), client::kMaxReply);
}

TEST_F(Calls, TheLargestRequestPasses) {
  HostPort port = tool();
  port.request(std::string(client::kMaxRequest, 'x'));
  until([&] { return !handler.requests.empty(); });
  EXPECT_EQ(handler.requests.front().data.size(), client::kMaxRequest);
}

TEST_F(Calls, WaitAndAskLeaveOtherMessagesForReceive) {
  HostPort port = tool();
  handler.when_asked = [&](const auto& call) { server->reply(call.client, call.token, "{}"); };
  const std::uint32_t first = port.send(1, {1});
  const std::uint32_t second = port.send(1, {2});
  until([&] { return handler.sends.size() == 2; });
  const host::ClientId id = handler.sends.front().client;
  server->result(id, {first, Outcome::delivered, {}, 1, ""});
  server->observed(id, "{}");
  server->result(id, {second, Outcome::lost, {}, 4, ""});
  EXPECT_EQ(during([&] { return port.wait(second, kGuard); }).outcome, Outcome::lost);
  during([&] { return port.ask("{}", kGuard); });
  EXPECT_EQ(next<Result>(port).token, first);
  next<Observed>(port);
}

TEST_F(Calls, EachClientGetsItsOwnResults) {
  HostPort one = tool(), two = tool();
  handler.when_sent = [&](const auto& call) {
    server->result(call.client, {call.token, Outcome::delivered, {}, 1, call.data});
  };
  const std::uint32_t from_one = one.send(1, {'1'});
  const std::uint32_t from_two = two.send(1, {'2'});
  EXPECT_EQ(during([&] { return two.wait(from_two, kGuard); }).reason, "2");
  EXPECT_EQ(during([&] { return one.wait(from_one, kGuard); }).reason, "1");
}

TEST_F(Calls, ObserveReachesTheHandlerAndWhatIsSeenComesBack) {
  HostPort port = tool();
  port.observe("{\"kinds\": []}");
  until([&] { return !handler.observers.empty(); });
  EXPECT_EQ(handler.observers.front().data, "{\"kinds\": []}");
  server->observed(handler.observers.front().client, "{\"seen\": 1}");
  EXPECT_EQ(next<Observed>(port).json, "{\"seen\": 1}");
}

TEST_F(Calls, AreAllSignsOfLife) {
  HostPort port = tool();
  port.alive();
  port.alive();
  port.send(1, {1});
  until([&] { return handler.sends.size() == 1; });
  EXPECT_EQ(handler.alive, 3u);
}

TEST_F(Calls, ThatTakeLongWaitForTheNextTurnAndEachClientHasOneInEach) {
  test::RawClient fast("r", "3"), second("r", "3");
  std::vector<std::pair<host::ClientId, std::uint64_t>> asked;
  handler.when_asked = [&](const auto& call) {
    asked.emplace_back(call.client, event_loop::PacketLoop::of(io).turns());
    const auto until = std::chrono::steady_clock::now() + host::HostServer::kTimePerTurn;
    while (std::chrono::steady_clock::now() < until) continue;
  };
  for (test::RawClient* client : {&fast, &second}) client->say(client::Greeting{});
  until([&] { return handler.attached.size() == 2; });
  client::Bytes burst;
  for (std::uint32_t i = 0; i < 20; ++i) client::append(burst, client::JsonRequest{i, "{}"});
  fast.say_bytes(burst);
  until([&] { return !asked.empty(); });
  second.say_bytes(burst);
  until([&] { return asked.size() == 40; });
  EXPECT_NE(asked[20].first, asked[21].first) << "the second client was kept waiting";
  std::sort(asked.begin(), asked.end());
  EXPECT_EQ(std::adjacent_find(asked.begin(), asked.end()), asked.end()) << "two in one turn";
}

TEST_F(Calls, AnswersForAClientThatIsGoneAreDropped) {
  host::ClientId id = 0;
  {
    HostPort port = tool();
    port.send(1, {1});
    until([&] { return !handler.sends.empty(); });
    id = handler.sends.front().client;
  }
  until([&] { return !handler.detached.empty(); });
  EXPECT_EQ(handler.detached.front().id, id);
  server->result(id, {});
  server->reply(id, 1, "{}");
  server->observed(id, "{}");
  server->disconnect(id, "again");
  EXPECT_EQ(handler.detached.size(), 1u);
}

}  // namespace
}  // namespace limb_ring
