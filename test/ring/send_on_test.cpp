// A stop that one node has sent is sent on by others.
#include "ring/reset_node.h"

#include <gmock/gmock.h>

#include <stdexcept>

namespace limb_ring::ask {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;
using std::chrono::steady_clock;
using ::testing::ElementsAre;

/// A stop that node 0 has sent, of a ring in which nodes 1 to 3 were not reached.
class SendOn : public ::testing::Test {
 protected:
  SendOn() { stop.delivered = true; }
  /// @param result what becomes of it from a node
  void send(steady_clock::duration time, const std::function<bool(std::uint8_t)>& result) {
    const SendStop sending = [&](std::uint8_t from, milliseconds) {
      sent.push_back(from);
      return result(from);
    };
    const NextSender next = [](const SentStop&, const std::set<std::uint8_t>& senders) {
      return senders.size() < 4 ? std::optional(static_cast<std::uint8_t>(senders.size())) : std::nullopt;
    };
    send_on(stop, 0, steady_clock::now() + time, sending, next);
  }

  SentStop stop;
  std::vector<std::uint8_t> sent;
};

TEST_F(SendOn, GoesOnUntilNobodyIsLeft) {
  send(1h, [](auto) { return true; });
  EXPECT_THAT(sent, ElementsAre(1, 2, 3));
  EXPECT_TRUE(stop.delivered);
}

TEST_F(SendOn, PassesOverANodeThatHasGone) {
  send(1h, [](std::uint8_t from) { return from == 2 ? throw std::runtime_error("gone") : true; });
  EXPECT_THAT(sent, ElementsAre(1, 2, 3));
}

TEST_F(SendOn, AsksNobodyAfterTheDeadlineOfTheWhole) {
  send(0s, [](auto) { return true; });
  EXPECT_THAT(sent, ElementsAre());
}

TEST_F(SendOn, ToAllIsDeliveredIfEachOneIs) {
  send(1h, [](std::uint8_t from) { return from != 2; });
  EXPECT_FALSE(stop.delivered);
}

TEST_F(SendOn, ToOneNodeIsDeliveredIfTheLastOneIs) {
  stop.of_all = false;
  send(1h, [](std::uint8_t from) { return from != 2; });
  EXPECT_TRUE(stop.delivered);
}

}  // namespace
}  // namespace limb_ring::ask
