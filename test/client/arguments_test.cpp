#include "client/arguments.h"

#include <gmock/gmock.h>

namespace limb_ring::client {
namespace {

using testing::HasSubstr;

TEST(Arguments, WithinTheirRangesAreNoProblem) {
  EXPECT_FALSE(send_problem(1, 0, 0));
  EXPECT_FALSE(send_problem(512, 3, 63));
  EXPECT_FALSE(interrupt_problem(7));
  EXPECT_FALSE(pull_problem(7));
}

TEST(Arguments, OutsideSayWhatIsAllowed) {
  EXPECT_EQ(send_problem(0, 0, 0), "size 0: a packet holds 1 to 512 bytes");
  EXPECT_EQ(send_problem(513, 0, 0), "size 513: a packet holds 1 to 512 bytes");
  EXPECT_EQ(send_problem(1, 4, 0), "priority 4: allowed are 0 (highest) to 3");
  EXPECT_EQ(send_problem(1, 0, 64), "channel 64: allowed are 0 to 63");
  EXPECT_THAT(*send_problem(1, 0, 1), HasSubstr("network controllers"));
  EXPECT_EQ(interrupt_problem(8), "factor 8: allowed are 0 to 7");
  EXPECT_EQ(pull_problem(8), "input 8: allowed are 0 to 7");
}

}  // namespace
}  // namespace limb_ring::client
