// Clients that say nonsense, nothing, or the wrong thing, and clients that are not wanted.
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include <random>

#include "node/host_fixture.h"
#include "node/raw_client.h"
#include "support/thrown.h"

namespace limb_ring {
namespace {

using test::HostTest;
using test::RawClient;
using testing::AllOf;
using testing::HasSubstr;

class UnknownPeer : public HostTest {
 protected:
  /// Waits until the client has been shown out. @return the daemon's last words
  std::string shown_out(RawClient& client) {
    until([&] { return client.hung_up(); });
    return client.last_words();
  }
  static client::Bytes greeting_bytes() {
    client::Bytes bytes;
    client::append(bytes, client::Greeting{});
    return bytes;
  }
  static ConnectOptions who_asks() {
    ConnectOptions options = options_for(Role::tool);
    options.asks_only = true;
    return options;
  }
  static client::Greeting asking() {
    client::Greeting greeting;
    greeting.asks_only = true;
    return greeting;
  }
  void expect_still_serving() { EXPECT_EQ(tool().id(), 3); }
};

TEST_F(UnknownPeer, SayingNothingKeepsNobodyOutHoweverManyThereAre) {
  std::vector<RawClient> silent;
  for (unsigned i = 0; i < 3 * (4 + host::HostServer::kKeptPlaces); ++i) {
    silent.emplace_back("r", "3");
    turn();
  }
  expect_still_serving();
  EXPECT_GT(server->counters().never_greeted, 0u);
  EXPECT_EQ(server->counters().refused_full, 0u);
  EXPECT_THAT(shown_out(silent.front()), HasSubstr("others want this one"));
}

TEST_F(UnknownPeer, TalkingAnotherProtocolIsDisconnected) {
  RawClient client("r", "3");
  const std::string http = "GET / HTTP/1.1\r\n\r\n";
  client.say_bytes(client::Bytes(http.begin(), http.end()));
  EXPECT_THAT(shown_out(client), HasSubstr("not a message of the host port"));
  EXPECT_EQ(server->counters().garbage, 1u);
  EXPECT_TRUE(handler.attached.empty());
  expect_still_serving();
}

TEST_F(UnknownPeer, ClaimingAHugeMessageIsDisconnectedAtOnce) {
  RawClient client("r", "3");
  client.say(client::Greeting{});
  client.say_bytes({0, 1, 0, 1, 2});
  shown_out(client);
  EXPECT_EQ(server->counters().garbage, 1u);
  until([&] { return handler.detached.size() == 1; });
  expect_still_serving();
}

TEST_F(UnknownPeer, SayingAnythingBeforeTheGreetingIsDisconnected) {
  RawClient client("r", "3");
  client.say(client::PullRequest{1, 1});
  shown_out(client);
  EXPECT_EQ(server->counters().garbage, 1u);
  EXPECT_TRUE(handler.pulls.empty());
}

TEST_F(UnknownPeer, GreetingTwiceIsDisconnected) {
  RawClient client("r", "3");
  client.say(client::Greeting{});
  client.say(client::Greeting{});
  shown_out(client);
  EXPECT_EQ(server->counters().garbage, 1u);
  EXPECT_EQ(handler.attached.size(), 1u);
}

TEST_F(UnknownPeer, GreetingByteByByteIsWelcome) {
  RawClient client("r", "3");
  for (const std::uint8_t byte : greeting_bytes()) {
    ASSERT_TRUE(client.say_bytes({byte}));
    turn();
  }
  until([&] { return handler.attached.size() == 1; });
  EXPECT_EQ(server->counters().garbage, 0u);
}

TEST_F(UnknownPeer, LeavingInTheMiddleOfItsGreetingIsForgotten) {
  const client::Bytes greeting = greeting_bytes();
  for (std::size_t size = 0; size < greeting.size(); ++size) {
    RawClient client("r", "3");
    client.say_bytes({greeting.data(), size});
    turn();
  }
  expect_still_serving();  // with max_clients 4: none of those is left
  EXPECT_EQ(handler.attached.size(), 1u);
  EXPECT_EQ(server->counters().garbage, 0u);
}

TEST_F(UnknownPeer, SayingNothingIsDisconnectedAfterAWhile) {
  RawClient client("r", "3");
  EXPECT_THAT(shown_out(client), HasSubstr("no greeting"));
  EXPECT_EQ(server->counters().never_greeted, 1u);
}

TEST_F(UnknownPeer, ThatEndsATurnThatItDoesNotHaveIsDisconnected) {
  RawClient client("r", "3");
  client.say(client::Greeting{});
  client.say(client::Waiting{});
  EXPECT_THAT(shown_out(client), HasSubstr("not a message"));
}

TEST_F(UnknownPeer, SayingRandomMessagesHarmsNobody) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  HostPort bystander = tool();
  for (int round = 0; round < 200; ++round) {
    RawClient client("r", "3");
    if (random() % 4 != 0) client.say(client::Greeting{});
    for (int i = 0; i < 10; ++i) {
      client::Bytes bytes{0, 0, 0, static_cast<std::uint8_t>(random() % 20)};
      bytes.resize(4 + bytes[3]);
      for (std::size_t at = 4; at < bytes.size(); ++at) {
        bytes[at] = static_cast<std::uint8_t>(random() % (at == 4 ? 10 : 256));
      }
      client.say_bytes(bytes);
    }
    turn();
  }
  until([&] { return handler.detached.size() + 1 == handler.attached.size(); });
  EXPECT_GT(server->counters().garbage, 0u);
  EXPECT_TRUE(bystander.connected());
  handler.when_asked = [&](const auto& call) { server->reply(call.client, call.token, "{}"); };
  EXPECT_EQ(during([&] { return bystander.ask("{}", test::kGuard); }), "{}");
}

TEST_F(UnknownPeer, WithBadArgumentsGetsThemRejected) {
  RawClient client("r", "3");
  const client::Bytes large(513);
  client.say(client::Greeting{});
  client.say(client::SendRequest{1, 2, 0, 0, {large.data(), large.size()}});
  client.say(client::SendRequest{2, 2, 0, 0, {}});
  client.say(client::SendRequest{3, 2, 4, 0, {large.data(), 1}});
  client.say(client::SendRequest{4, 2, 0, 1, {large.data(), 1}});
  client.say(client::InterruptRequest{5, 2, 8, false});
  client.say(client::PullRequest{6, 8});
  until([&] { return server->counters().rejected == 6; });
  EXPECT_TRUE(handler.sends.empty());
  EXPECT_TRUE(handler.interrupts.empty());
  EXPECT_TRUE(handler.pulls.empty());
}

TEST_F(UnknownPeer, OfAnotherRingIsRefused) {
  RawClient client("r", "3");
  client::Greeting greeting;
  greeting.ring = "other";
  client.say(greeting);
  EXPECT_EQ(shown_out(client), "node 3 (left_knee) belongs to ring r, not to other");
  EXPECT_EQ(server->counters().refused, 1u);
}

TEST_F(UnknownPeer, OfAnotherVersionIsToldBoth) {
  RawClient client("r", "3");
  client::Greeting greeting;
  greeting.version = 7;
  client.say(greeting);
  EXPECT_THAT(shown_out(client), AllOf(HasSubstr("version 3"), HasSubstr("version 7")));
}

TEST_F(UnknownPeer, BeyondTheLimitOfClientsIsToldTheLimit) {
  HostPort one = tool(), two = tool(), three = tool();
  for (HostPort* port : {&one, &two, &three}) port->observe("{}");  // an idle one would make room
  {
    HostPort four = tool();
    four.observe("{}");
    until([&] { return handler.observers.size() == 4; });
    EXPECT_THAT(test::thrown<HostPortError>([&] { tool(); }), HasSubstr("limits.clients"));
    EXPECT_EQ(server->counters().refused_full, 1u);
  }
  until([&] { return handler.detached.size() == 1; });
  expect_still_serving();
}

TEST_F(UnknownPeer, AClientThatOnlyAsksAndTheCpuHaveAPlaceBeyondTheLimit) {
  const HostPort one = tool(), two = tool(), three = tool(), four = tool();
  const HostPort its_cpu = cpu();
  std::vector<HostPort> kept;
  while (kept.size() + 1 < host::HostServer::kKeptPlaces) kept.push_back(connect(who_asks()));
  EXPECT_THAT(test::thrown<HostPortError>([&] { connect(who_asks()); }), HasSubstr("limits.clients"));
}

TEST_F(UnknownPeer, ThatGreetsAndStaysSilentKeepsNobodyOut) {
  std::vector<RawClient> silent;
  for (unsigned i = 0; i < 4 + host::HostServer::kKeptPlaces; ++i) {
    silent.emplace_back("r", "3");
    silent.back().say(i < 4 ? client::Greeting{} : asking());
    until([&] { return handler.attached.size() == i + 1; });
  }
  silent[1].say(client::ObserveRequest{"{}"});
  until([&] { return handler.observers.size() == 1; });
  silent[2].say(client::JsonRequest{1, "{}"});  // whose answer may take long
  until([&] { return handler.requests.size() == 1; });
  const auto all_idle = std::chrono::steady_clock::now() + host::HostServer::kIdleFor;
  until([&] { return std::chrono::steady_clock::now() > all_idle; });
  const HostPort asks = connect(who_asks());
  const HostPort stays = tool();
  EXPECT_THAT(shown_out(silent[0]), HasSubstr("others want this one"));
  EXPECT_FALSE(silent[1].hung_up() || silent[2].hung_up());
  EXPECT_EQ(server->counters().displaced, 2u);
  EXPECT_EQ(server->counters().refused_full, 0u);
}

TEST_F(UnknownPeer, OfAProcessThatHoldsMostPlacesMakesRoomForAnotherProcess) {
  const pid_t other = ::fork();
  if (other == 0) {
    std::vector<RawClient> all;
    for (int i = 0; i < 8; ++i) {
      all.emplace_back("r", "3");
      all.back().say(i < 4 ? client::Greeting{} : asking());
      all.back().say(client::ObserveRequest{"{}"});
    }
    for (;;) ::pause();
  }
  until([&] { return handler.observers.size() == 8; });
  const HostPort one = tool(), two = tool();
  EXPECT_THAT(test::thrown<HostPortError>([&] { tool(); }), HasSubstr("limits.clients")) << "it holds 6 of 12 now";
  EXPECT_EQ(server->counters().displaced, 2u);
  ::kill(other, SIGKILL);
  ::waitpid(other, nullptr, 0);
}

TEST_F(UnknownPeer, OfAnotherUserIsRefused) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  for (const std::string& path : {folder.path(), rings_directory(), ring_directory("r")}) {
    chmod(path.c_str(), 0755);
  }
  chmod((ring_directory("r") + "/3.host").c_str(), 0777);
  ASSERT_EQ(seteuid(65534), 0);
  RawClient client("r", "3");
  ASSERT_EQ(seteuid(0), 0);
  client.say(client::Greeting{});
  EXPECT_THAT(shown_out(client), HasSubstr("belongs to user 0, not to 65534"));
  EXPECT_EQ(server->counters().refused_foreign, 1u);
  EXPECT_TRUE(handler.attached.empty());
}

}  // namespace
}  // namespace limb_ring
