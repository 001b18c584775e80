// The bounds that the pictures draw: protocol.md section 7.2, by hand.
#include "study/model_ring.h"

#include "comparison/test/network_fixture.h"

namespace limb_ring::study {
namespace {

// T = 524 * 8 ns = 4.192 us; 16 (T + d) = 16 * 4.704 us.
TEST(RingBounds, OfData) {
  EXPECT_EQ(packet_time(gigabit(16)), 4192ns);
  EXPECT_EQ(data_bound(gigabit(16), 16), 75264ns);
  EXPECT_EQ(data_bound(gigabit(16), 8), 37632ns);
}

// At every node d, 96 ns behind an INTP, and 8 bytes of trailer and CRC: 512 + 96 + 64 ns.
TEST(RingBounds, OfInterrupts) { EXPECT_EQ(interrupt_bound(gigabit(16)), 16 * 672ns); }

// Three odd bytes more: 512 + 96 + 88 ns.
TEST(RingBounds, OfInterruptsBehindOddBytes) { EXPECT_EQ(interrupt_bound(gigabit(16, 511)), 16 * 696ns); }

// At every node d, 96 ns and T: 512 + 96 + 4192 ns.
TEST(RingBounds, OfInterruptsThatAreNotEmbedded) {
  EXPECT_EQ(interrupt_bound_between_packets(gigabit(16)), 16 * 4800ns);
}

}  // namespace
}  // namespace limb_ring::study
