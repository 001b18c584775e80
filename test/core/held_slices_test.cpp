// Slices that a fold holds back until its input has settled.
#include "core/fold/fold_back.h"

#include "core/ring_fixture.h"

namespace limb_ring::core {
namespace {

TEST(HeldSlices, AreCountedWithoutThoseThatHaveGone) {
  HeldSlices held;
  const Bytes word = pattern(4);
  for (int i = 0; i < 3; ++i) held.put({wire::SliceKind::more, {word.data(), word.size()}});
  held.pop();
  EXPECT_EQ(held.count(), 2u);
}

TEST(HeldSlices, HaveRoomAgainForThoseThatHaveGone) {
  HeldSlices held;
  const Bytes word = pattern(4);
  held.put({wire::SliceKind::more, {word.data(), word.size()}});
  held.put({wire::SliceKind::more, {word.data(), word.size()}});
  held.pop();
  EXPECT_EQ(held.bytes(), 4u);
  held.pop();
  EXPECT_EQ(held.bytes(), 0u);
}

// A line that brings as much as is taken off: it is never empty.
TEST(HeldSlices, AreThoseThatWerePutHoweverManyHaveGone) {
  HeldSlices held;
  held.put({wire::SliceKind::abort, {}});
  for (std::size_t size = 0; size < 300; ++size) {
    const Bytes bytes = pattern(size % 100);
    held.put({wire::SliceKind::more, {bytes.data(), bytes.size()}});
    held.pop();
    ASSERT_EQ(Bytes(held.front().bytes.begin(), held.front().bytes.end()), bytes);
    ASSERT_EQ(held.bytes(), bytes.size());
  }
}

}  // namespace
}  // namespace limb_ring::core
