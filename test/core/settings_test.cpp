// What a network controller does where nobody has said otherwise. (protocol.md sections 7.2 and 7.3)
#include "core/settings.h"

#include <gtest/gtest.h>

namespace limb_ring::core {
namespace {

using namespace std::chrono_literals;

TEST(Settings, HaveTheTimesOfTheTableOfTimersUnlessOthersAreGiven) {
  const Settings settings;
  EXPECT_EQ(settings.send_timeout_least, Duration{100ms});
  EXPECT_EQ(settings.refused_for, Duration{1s});
  EXPECT_EQ(settings.refused_backoff, Duration{1ms});
  EXPECT_EQ(settings.refused_backoff_most, Duration{64ms});
  EXPECT_EQ(settings.queue_timeout, Duration{5s});
  EXPECT_EQ(settings.stall, Duration{50ms});
  EXPECT_EQ(settings.beacon, Duration{100ms});
  EXPECT_EQ(settings.break_grace, Duration{200ms});
  EXPECT_EQ(settings.fold_permission, Duration{200ms});
}

TEST(Settings, AreOfALineThatTakesNoTimeUnlessARateIsGiven) {
  const Settings settings;
  EXPECT_EQ(settings.byte_time_in, Duration{0});
  EXPECT_EQ(settings.byte_time_out, Duration{0});
  EXPECT_EQ(settings.worst_lap(), Duration{0});
}

}  // namespace
}  // namespace limb_ring::core
