// A client of a virtual ring that has greeted, but is still booting in the ring's time.
#include <unistd.h>

#include <optional>
#include <utility>

#include "node/host_fixture.h"
#include "node/raw_client.h"

namespace limb_ring {
namespace {

using test::HostTest;
using test::RawClient;

/// Lets nobody in before the test does.
struct SlowTurns final : host::TurnKeeper {
  std::chrono::nanoseconds now() const override { return {}; }
  void greeted(std::uint8_t, std::function<void()> attach) override { let_in = std::move(attach); }
  void left(std::uint8_t) override { ++left_ones; }
  void joined(std::uint8_t, const std::shared_ptr<host::Session>& session) override { joined_session = session; }
  void has_news() override {}
  void disturbed() override {}

  std::function<void()> let_in;
  int left_ones = 0;
  std::shared_ptr<host::Session> joined_session;
};

struct UnattachedClient : HostTest {
  UnattachedClient() {
    server.reset();
    host::HostOptions options;
    options.directory = make_ring_directory("r");
    options.ring = "r";
    options.id = 3;
    options.name = "left_knee";
    options.turns = &turns;
    server = std::make_unique<host::HostServer>(io, options, handler);
  }
  static client::Greeting cpu_greeting() {
    client::Greeting greeting;
    greeting.role = Role::cpu;
    greeting.lockstep = true;
    return greeting;
  }
  SlowTurns turns;
};

TEST_F(UnattachedClient, IsTheOneCpuOfItsNodeFromItsGreetingOn) {
  RawClient first("r", "3");
  first.say(cpu_greeting());
  until([&] { return turns.let_in != nullptr; });
  const auto let_first_in = std::exchange(turns.let_in, nullptr);
  RawClient second("r", "3");
  second.say(cpu_greeting());
  until([&] { return second.hung_up(); });
  EXPECT_THAT(second.last_words(), testing::HasSubstr("has a CPU already: pid " + std::to_string(getpid())));
  EXPECT_EQ(turns.let_in, nullptr);
  let_first_in();
  EXPECT_NE(turns.joined_session, nullptr);
  EXPECT_FALSE(first.hung_up());
}

TEST_F(UnattachedClient, MakesRoomWhenItLeaves) {
  std::optional<RawClient> first(std::in_place, "r", "3");
  first->say(cpu_greeting());
  until([&] { return turns.let_in != nullptr; });
  turns.let_in = nullptr;
  first.reset();
  until([&] { return turns.left_ones == 1; });
  EXPECT_THAT(handler.left, testing::ElementsAre(getpid()));
  RawClient second("r", "3");
  second.say(cpu_greeting());
  until([&] { return turns.let_in != nullptr; });
  turns.let_in();
  EXPECT_NE(turns.joined_session, nullptr);
  EXPECT_EQ(handler.detached.size(), 0u);
}

TEST_F(UnattachedClient, ThatIsRefusedAfterItsBootIsGone) {
  handler.objection = "not now";
  RawClient client("r", "3");
  client.say(cpu_greeting());
  until([&] { return turns.let_in != nullptr; });
  turns.let_in();
  EXPECT_TRUE(client.hung_up());
  EXPECT_THAT(handler.left, testing::ElementsAre(getpid()));
}

TEST_F(UnattachedClient, ThatIsNotACpuIsNotInLockstepEvenIfItAsksForIt) {
  client::Greeting greeting = cpu_greeting();
  greeting.role = Role::tool;
  RawClient tool("r", "3");
  tool.say(greeting);
  until([&] { return !handler.attached.empty(); });
  EXPECT_FALSE(handler.attached.front().lockstep);
  EXPECT_EQ(turns.joined_session, nullptr);
}

TEST_F(UnattachedClient, IsReadUpToALimitAndTheRestOnceItIsIn) {
  constexpr std::size_t kFarTooMuch = 16 << 20, kLot = 1000;
  client::Bytes lot;
  for (std::size_t i = 0; i < kLot; ++i) client::append(lot, client::Alive{});
  RawClient client("r", "3");
  client.say(cpu_greeting());
  until([&] { return turns.let_in != nullptr; });
  std::size_t lots = 0;
  for (int in_vain = 0; in_vain < 100 && lots * lot.size() < kFarTooMuch; turn()) {
    const bool went = client.say_bytes(lot);
    lots += went ? 1 : 0;
    in_vain = went ? 0 : in_vain + 1;
  }
  EXPECT_LT(lots * lot.size(), kFarTooMuch);
  turns.let_in();
  ASSERT_NE(turns.joined_session, nullptr);
  turns.joined_session->begin_turn({});
  while (turns.joined_session->await_message()) {
  }
  EXPECT_GE(handler.alive, lots * kLot);
}

}  // namespace
}  // namespace limb_ring
