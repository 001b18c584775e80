#include "study/response.h"

#include <gmock/gmock.h>

namespace limb_ring::study {
namespace {

using namespace std::chrono_literals;

constexpr Duration kLimit = 1s;

Contender contender(unsigned rank, Duration lap, Duration period, unsigned jobs = 1, Duration jitter = Duration{0}) {
  return {rank, jobs, lap * static_cast<int>(jobs), lap, lap, period, jitter};
}

TEST(Response, AMessageAloneWaitsForWhatIsOnTheLine) {
  const auto alone = worst_response({contender(0, 10us, 100us)}, 0, 3us, kLimit);
  ASSERT_TRUE(alone);
  EXPECT_EQ(alone->wait, 3us);
  EXPECT_EQ(alone->own, 1u);
  EXPECT_EQ(alone->others, 0u);
  EXPECT_FALSE(alone->lower);
}

TEST(Response, ALowerPriorityUnderWayIsWaitedForOnce) {
  const auto high =
      worst_response({contender(0, 10us, 1ms), contender(1, 20us, 1ms), contender(2, 15us, 1ms)}, 0, 3us, kLimit);
  ASSERT_TRUE(high);
  EXPECT_EQ(high->wait, 20us);  // the longer of the two
  EXPECT_TRUE(high->lower);
}

TEST(Response, HigherAndSamePrioritiesGoFirst) {
  const auto low =
      worst_response({contender(0, 10us, 1ms), contender(1, 20us, 1ms), contender(1, 15us, 1ms)}, 2, 3us, kLimit);
  ASSERT_TRUE(low);
  EXPECT_EQ(low->wait, 33us);
  EXPECT_EQ(low->others, 2u);
}

// w = 3 + 10 n(w): 3, 13, 13 -> n(13) = floor(13 / 12) + 1 = 2 -> 23; n(23) = 2: 23.
TEST(Response, AHigherPriorityMayComeAgainWhileItIsWaitedFor) {
  const auto low = worst_response({contender(0, 10us, 12us), contender(1, 1us, 1ms)}, 1, 3us, kLimit);
  ASSERT_TRUE(low);
  EXPECT_EQ(low->wait, 23us);
  EXPECT_EQ(low->others, 2u);
}

// The first with 10 us of jitter counts once more: n(13) = floor((13 + 10) / 12) + 1 = 2, n(23) = 3,
// n(33) = floor(43 / 12) + 1 = 4, n(43) = 5, n(53) = 6, n(63) = 7, n(73) = 7: 73.
TEST(Response, JitterOfAHigherPriorityBringsItsMessagesTogether) {
  const auto low = worst_response({contender(0, 10us, 12us, 1, 10us), contender(1, 1us, 1ms)}, 1, 3us, kLimit);
  ASSERT_TRUE(low);
  EXPECT_EQ(low->wait, 73us);
}

TEST(Response, TheLastPacketOfAMessageWaitsForThoseBeforeIt) {
  const auto burst = worst_response({contender(0, 10us, 1ms, 3)}, 0, 3us, kLimit);
  ASSERT_TRUE(burst);
  EXPECT_EQ(burst->wait, 23us);
  EXPECT_EQ(burst->own, 3u);
}

// C = 2.8, P = 4, J = 6: busy = 2.8 n(busy) has n = 6. w(q) = 2.8 q, asked for at max(0, 4 q - 6):
// q = 0: 0, 1: 2.8, 2: 5.6 - 2 = 3.6, 3: 8.4 - 6 = 2.4, ...
TEST(Response, AJitterAboveThePeriodMakesAStreamWaitForItself) {
  const auto own = worst_response({contender(0, 2800ns, 4us, 1, 6us)}, 0, Duration{0}, kLimit);
  ASSERT_TRUE(own);
  EXPECT_EQ(own->wait, 3600ns);
  EXPECT_EQ(own->own, 3u);
}

// The example of Davis et al.: A, B, C take 1 ms each, periods 2.5, 3.5, 3.5 ms; response times 2, 3, 3.5 ms.
// C's second message is the worse one: w(0) = 2; w(1) = 1 + n_A + n_B = 6 = 1 + 3 + 2, asked for at 3.5.
TEST(Response, EveryMessageOfABusyPeriodIsJudged) {
  const std::vector<Contender> unit{contender(0, 1ms, 2500us), contender(1, 1ms, 3500us), contender(2, 1ms, 3500us)};
  EXPECT_EQ(worst_response(unit, 0, Duration{0}, kLimit)->wait, 1ms);
  EXPECT_EQ(worst_response(unit, 1, Duration{0}, kLimit)->wait, 2ms);
  EXPECT_EQ(worst_response(unit, 2, Duration{0}, kLimit)->wait, 2500us);
}

TEST(Response, ALoadOfOneOrMoreHasNoBound) {
  const std::vector<Contender> unit{contender(0, 6us, 10us), contender(1, 4us, 10us)};
  EXPECT_TRUE(worst_response(unit, 0, 3us, kLimit));
  EXPECT_FALSE(worst_response(unit, 1, 3us, kLimit));
}

TEST(Response, AWaitAboveTheLimitHasNoBound) {
  EXPECT_TRUE(worst_response({contender(0, 10us, 1ms, 3)}, 0, 3us, 100us));
  EXPECT_FALSE(worst_response({contender(0, 10us, 1ms, 3)}, 0, 3us, 20us));
}

}  // namespace
}  // namespace limb_ring::study
