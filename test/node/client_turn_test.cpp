#include "node/session.h"

#include <gtest/gtest.h>

namespace limb_ring::host {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

/// A clock that a test sets; counts what it is told.
class SetTurns : public TurnKeeper {
 public:
  nanoseconds now() const override { return now_; }
  void greeted(std::uint8_t, std::function<void()>) override {}
  void left(std::uint8_t) override {}
  void joined(std::uint8_t, const std::shared_ptr<Session>&) override {}
  void has_news() override { ++news_; }
  void disturbed() override {}

  nanoseconds now_{0};
  int news_ = 0;
};

class ClientTurnTest : public ::testing::Test {
 protected:
  SetTurns keeper_;
  ClientTurn turn_{keeper_};
};

TEST_F(ClientTurnTest, NewsWaitsForTheNextTurnWhichTheKeeperHearsOf) {
  turn_.end(9ms);
  turn_.tell_news();
  EXPECT_TRUE(turn_.has_news());
  EXPECT_EQ(keeper_.news_, 1);
  turn_.begin();
  EXPECT_TRUE(turn_.is_on());
  EXPECT_FALSE(turn_.has_news()) << "it is given with the turn";
}

TEST_F(ClientTurnTest, TheNextOneComesWhenTheClientWantsItOrSooner) {
  turn_.begin();
  turn_.end(50ms);
  EXPECT_FALSE(turn_.is_on());
  EXPECT_EQ(turn_.next(), 50ms);
  keeper_.now_ = 10ms;
  turn_.comes_within(20ms);
  EXPECT_EQ(turn_.next(), 30ms);
  keeper_.now_ = 15ms;
  turn_.comes_within(20ms);
  EXPECT_EQ(turn_.next(), 30ms) << "never later than it was to come";
}

TEST_F(ClientTurnTest, AClientThatHasTakenTooLongIsAwaitedAgainOnceItsTurnHasEnded) {
  turn_.begin();
  EXPECT_TRUE(turn_.is_awaited());
  turn_.await_no_more();
  EXPECT_FALSE(turn_.is_awaited());
  turn_.end(1ms);
  EXPECT_TRUE(turn_.is_awaited());
}

}  // namespace
}  // namespace limb_ring::host
