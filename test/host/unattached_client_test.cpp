// A client of a virtual ring that has greeted, and whose boot in the ring's time is not over.
#include "host/host_fixture.h"
#include "host/raw_client.h"

namespace limb_ring {
namespace {

using test::HostTest;
using test::RawClient;

/// Lets nobody in before the test does.
struct SlowTurns final : host::TurnKeeper {
  std::chrono::nanoseconds now() const override { return {}; }
  void greeted(std::uint8_t, std::function<void()> attach) override { let_in = std::move(attach); }
  void joined(std::uint8_t, const std::shared_ptr<host::Session>& session) override { joined_session = session; }
  void has_news() override {}
  void disturbed() override {}

  std::function<void()> let_in;
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
  SlowTurns turns;
};

TEST_F(UnattachedClient, IsReadUpToALimitAndTheRestOnceItIsIn) {
  constexpr std::size_t kFarTooMuch = 16 << 20, kLot = 1000;
  client::Bytes lot;
  for (std::size_t i = 0; i < kLot; ++i) client::append(lot, client::Alive{});
  RawClient client("r", "3");
  client::Greeting greeting;
  greeting.role = Role::cpu;
  greeting.lockstep = true;
  client.say(greeting);
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
  while (turns.joined_session->listen()) {
  }
  EXPECT_GE(handler.alive, lots * kLot);
}

}  // namespace
}  // namespace limb_ring
