#include "io/node_clock.h"

#include <gtest/gtest.h>

#include <vector>

namespace limb_ring::event_loop {
namespace {

using std::chrono::milliseconds;

struct Tickers : testing::Test {
  boost::asio::io_context io;
};

TEST_F(Tickers, OfOnePeriodTickTogether) {
  std::vector<Ticker::Time> first, second;
  Ticker a(io, milliseconds(2), [&](Ticker::Time now) { first.push_back(now); });
  Ticker b(io, milliseconds(2), [&](Ticker::Time now) {
    second.push_back(now);
    if (second.size() == 5) io.stop();
  });
  io.run();
  EXPECT_EQ(first, second) << "one wake-up for both";
  EXPECT_EQ(first.size(), 5u);
}

TEST_F(Tickers, TickAtTheSameInstantsInAllProcesses) {
  const Ticker::Time zero{};
  EXPECT_EQ(next_tick(zero + milliseconds(1001), milliseconds(20)), zero + milliseconds(1020));
  EXPECT_EQ(next_tick(zero + milliseconds(1019), milliseconds(20)), zero + milliseconds(1020));
  EXPECT_EQ(next_tick(zero + milliseconds(1020), milliseconds(20)), zero + milliseconds(1040)) << "not twice";
}

TEST_F(Tickers, AnotherPeriodIsItsOwn) {
  int fast = 0, slow = 0;
  Ticker a(io, milliseconds(1), [&](Ticker::Time) { ++fast; });
  Ticker b(io, milliseconds(20), [&](Ticker::Time) {
    if (++slow == 2) io.stop();
  });
  io.run();
  EXPECT_GT(fast, slow);
}

TEST_F(Tickers, MayBeStoppedAndBegunFromWithinACall) {
  int calls = 0;
  std::unique_ptr<Ticker> next;
  Ticker other(io, milliseconds(1), [](Ticker::Time) { FAIL() << "it was stopped before"; });
  Ticker* stopped = &other;
  Ticker first(io, milliseconds(1), [&](Ticker::Time) {
    ++calls;
    next = std::make_unique<Ticker>(io, milliseconds(1), [&](Ticker::Time) { io.stop(); });
  });
  stopped->stop();
  io.run();
  EXPECT_GE(calls, 1);
}

TEST_F(Tickers, TheLoopEndsWithTheLast) {
  int calls = 0;
  Ticker ticker(io, milliseconds(1), [&](Ticker::Time) {
    if (++calls == 2) ticker.stop();
  });
  io.run();
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace limb_ring::event_loop
