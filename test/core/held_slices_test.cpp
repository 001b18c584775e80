// What a fold holds until its input has settled.
#include "core/fold/held_slices.h"

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

TEST(HeldSlices, HaveRoomAgainOnceAllHaveGone) {
  HeldSlices held;
  const Bytes word = pattern(4);
  held.put({wire::SliceKind::more, {word.data(), word.size()}});
  held.pop();
  EXPECT_EQ(held.bytes(), 0u);
}

}  // namespace
}  // namespace limb_ring::core
