// A node of a virtual ring that stands still: who connects meanwhile, and what becomes of its folder.
#include "node/host_fixture.h"
#include "node/raw_client.h"

namespace limb_ring {
namespace {

using test::HostTest;
using test::RawClient;

struct FrozenHost : HostTest {
  void some_turns() {
    for (int i = 0; i < 10; ++i) turn();
  }
};

TEST_F(FrozenHost, ServesAllWhoHaveComeWhenItGoesOnEvenIfItsFolderWasRemoved) {
  server->freeze();
  RawClient first("r", "3");
  first.say(client::Greeting{});
  some_turns();
  server->listen_again();
  RawClient second("r", "3");
  second.say(client::Greeting{});
  some_turns();
  server->thaw();
  until([&] { return handler.attached.size() == 2; });
  EXPECT_FALSE(first.hung_up());
  EXPECT_FALSE(second.hung_up());
}

TEST_F(FrozenHost, WhoseFolderWasRemovedBeforeAnybodyConnectedServesLaterClients) {
  server->freeze();
  server->listen_again();
  RawClient client("r", "3");
  client.say(client::Greeting{});
  some_turns();
  EXPECT_EQ(handler.attached.size(), 0u);
  server->thaw();
  until([&] { return handler.attached.size() == 1; });
}

}  // namespace
}  // namespace limb_ring
