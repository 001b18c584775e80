#include "node/event_router.h"

#include <gmock/gmock.h>

namespace limb_ring::runtime {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

core::Counters counted(std::uint64_t crc_errors, std::uint64_t returns_damaged) {
  core::Counters counters;
  counters.crc_errors = crc_errors;
  counters.returns_damaged = returns_damaged;
  return counters;
}

const core::Time kStart{seconds(100)};

TEST(LatelyDamaged, IsWhatCameWithinTheLastTenSeconds) {
  LatelyDamaged lately;
  EXPECT_EQ(lately.counts(kStart).crc_errors, 0u);
  lately.look(kStart, counted(3, 1));
  lately.look(kStart + milliseconds(500), counted(4, 1));
  lately.look(kStart + seconds(6), counted(6, 2));
  const auto both = lately.counts(kStart + seconds(10));
  EXPECT_EQ(both.crc_errors, 6u);
  EXPECT_EQ(both.returns_damaged, 2u);
  EXPECT_TRUE(both.oldest == seconds(10));
  const auto later = lately.counts(kStart + seconds(11));
  EXPECT_EQ(later.crc_errors, 2u);
  EXPECT_EQ(later.returns_damaged, 1u);
  EXPECT_TRUE(later.oldest == seconds(5));
  EXPECT_EQ(lately.counts(kStart + seconds(17)).crc_errors, 0u);
}

TEST(LatelyDamaged, ForgetsWhatIsOverIfMoreComes) {
  LatelyDamaged lately;
  for (unsigned i = 1; i <= 100; ++i) lately.look(kStart + seconds(i), counted(i, 0));
  EXPECT_EQ(lately.counts(kStart + seconds(100)).crc_errors, 11u);
}

TEST(RoundTrips, AreOfTheLastMinuteSoThatOnePauseIsForgotten) {
  RoundTrips trips;
  EXPECT_FALSE(trips.row(kStart).since_s);
  trips.add(kStart, seconds(1));  // a pause of the machine
  trips.add(kStart + seconds(30), milliseconds(2));
  const auto both = trips.row(kStart + seconds(60));
  EXPECT_EQ(both.max, 1e6);
  EXPECT_EQ(both.since_s, 60.0);
  const auto later = trips.row(kStart + seconds(61));
  EXPECT_EQ(later.max, 2e3);
  EXPECT_EQ(later.samples, 1);
  EXPECT_EQ(later.since_s, 31.0);
}

}  // namespace
}  // namespace limb_ring::runtime
