// A client for whom the kernel watches no more descriptors.
#include "node/host_fixture.h"
#include "node/raw_client.h"
#include "support/refused_watches.h"

namespace limb_ring {
namespace {

using test::HostTest;
using test::RawClient;

TEST_F(HostTest, AClientThatCannotBeWaitedForIsTurnedAwayAndTheOthersAreServed) {
  HostPort other = tool();
  {
    RawClient client("r", "3");
    const test::RefusedWatches full(1);  // Asio's own, as it accepts
    until([&] { return client.hung_up(); });
  }
  EXPECT_EQ(server->counters().refused_unwatched, 1u);
  other.send(1, {1, 2, 3});
  until([&] { return handler.sends.size() == 1; });
  EXPECT_EQ(tool().id(), 3);
}

}  // namespace
}  // namespace limb_ring
