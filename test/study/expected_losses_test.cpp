// What expected delay and loss of a real network do to a plan.
#include "study/traffic_run.h"

#include "study/plan.h"
#include "study/small_ring.h"

namespace limb_ring::study {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Two lines of four cross a network.
config::RingConfig between_hosts(double loss, std::chrono::nanoseconds delay) {
  config::RingConfig ring = small_ring(4);
  for (const std::size_t node : {0, 2}) ring.nodes[node].link.expected = {delay, loss};
  return ring;
}

TEST(ExpectedLosses, AreOfAllLinesOfALapAndOfFourTries) {
  EXPECT_FALSE(expected_losses(small_ring(4)));
  const auto losses = expected_losses(between_hosts(0.1, 0ns));
  ASSERT_TRUE(losses);
  EXPECT_NEAR(losses->home, 0.81, 1e-9);
  EXPECT_NEAR(losses->delivered, 1 - 0.19 * 0.19 * 0.19 * 0.19, 1e-9);
  EXPECT_NEAR(losses->tries, 1 + 0.19 + 0.19 * 0.19 + 0.19 * 0.19 * 0.19, 1e-9);
}

TEST(ExpectedDelay, IsInTheBoundsAndInTheTimeOutOfATry) {
  const auto stream = stream_from(0, 1, {kHundred}, 1s);
  const Plan before = plan(small_ring(4), {stream}), after = plan(between_hosts(0, 60ms), {stream});
  EXPECT_EQ(*after.streams[0].confirmed - *before.streams[0].confirmed, 120ms);
  EXPECT_GT(expected_losses(between_hosts(0.01, 60ms))->timeout, 240ms);
}

// Three signs of life in 60 ms: all lost once in 0.05^-3 ticks and a little more.
TEST(ShortTimeouts, AreThoseThatTakeALineForBroken) {
  EXPECT_THAT(short_timeouts(between_hosts(0, 0ns)), IsEmpty());
  config::RingConfig ring = between_hosts(0.05, 1ms);
  ring.timeouts.idle = 20ms;
  ring.timeouts.silence = 60ms;
  EXPECT_NEAR(seconds_to_false_silence(ring.timeouts, 0.05), 0.02 * 8000 / 0.95, 1e-6);
  EXPECT_THAT(short_timeouts(ring), testing::Contains(HasSubstr("would be taken for broken every 2.81 min")));
  EXPECT_EQ(advised_silence(ring.timeouts, 0.05), 120ms);
  ring.timeouts.silence = 120ms;
  EXPECT_THAT(short_timeouts(ring), IsEmpty());
  EXPECT_TRUE(plan(ring, {}).carried());
}

TEST(ShortTimeouts, AreThoseThatDoNotWaitForABypass) {
  config::RingConfig ring = between_hosts(0, 100ms);
  EXPECT_THAT(short_timeouts(ring), ElementsAre(HasSubstr("timeouts.break_grace 200ms is too short")));
  ring.timeouts.break_grace = 360ms;
  EXPECT_THAT(short_timeouts(ring), IsEmpty());
}

TEST(ExpectedWords, SayWhatIsExpectedOfWhichLine) {
  EXPECT_EQ(expected_words(small_ring(4)), "");
  const std::string words = expected_words(between_hosts(0.01, 2ms));
  EXPECT_THAT(words, HasSubstr("2ms one way, 1 % lost"));
  EXPECT_THAT(words, HasSubstr("98 %"));
  EXPECT_THAT(words, HasSubstr("within four tries all but 0.157 in a million"));
  EXPECT_THAT(expected_words(between_hosts(0.1, 2ms)), HasSubstr("within four tries all but 0.13 %"));
}

}  // namespace
}  // namespace limb_ring::study
