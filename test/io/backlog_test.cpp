#include "io/packet_loop.h"

#include <gtest/gtest.h>

namespace limb_ring::event_loop {
namespace {

constexpr std::size_t kLimit = 1 << 20;
const std::vector<std::uint8_t> kPacket(1000, 7);

TEST(Backlog, HandsOutItsBytesInOrderWhateverWasTakenBefore) {
  Backlog backlog(kLimit);
  std::uint8_t in = 0, out = 0;
  for (int round = 0; round < 1000; ++round) {
    for (int i = 0; i < 7; ++i) ASSERT_TRUE(backlog.add({&++in, 1}));
    for (int i = 0; i < (round % 2 == 0 ? 5 : 8) && !backlog.empty(); ++i) {
      ASSERT_EQ(backlog.view()[0], ++out);
      backlog.remove(1);
    }
  }
}

TEST(Backlog, ThatIsNeverEmptyDoesNotGrow) {
  Backlog backlog(kLimit);
  ASSERT_TRUE(backlog.add({kPacket.data(), kPacket.size()}));
  for (int i = 0; i < 20000; ++i) {
    ASSERT_TRUE(backlog.add({kPacket.data(), kPacket.size()}));
    backlog.remove(kPacket.size());
  }
  EXPECT_EQ(backlog.size(), kPacket.size());
  EXPECT_LE(backlog.kept(), 4 * kPacket.size());
}

TEST(Backlog, TakesNoMoreThanItsLimit) {
  Backlog backlog(kLimit);
  std::size_t taken = 0;
  while (backlog.add({kPacket.data(), kPacket.size()})) taken += kPacket.size();
  EXPECT_EQ(taken, kLimit / kPacket.size() * kPacket.size());
  EXPECT_EQ(backlog.size(), taken);
}

TEST(Backlog, TellsAWriterThatAppendsTooMuch) {
  Backlog backlog(2 * kPacket.size());
  const auto append = [&] { backlog.to_append().insert(backlog.to_append().end(), kPacket.begin(), kPacket.end()); };
  append();
  append();
  EXPECT_FALSE(backlog.is_over_limit());
  append();
  EXPECT_TRUE(backlog.is_over_limit());
  backlog.remove(kPacket.size());
  EXPECT_FALSE(backlog.is_over_limit());
}

}  // namespace
}  // namespace limb_ring::event_loop
