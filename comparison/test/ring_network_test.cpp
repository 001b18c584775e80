// Our own ring as one of the methods: the figures of protocol.md section 7.2, at the destination.

#include "comparison/ring_network.h"
#include "comparison/test/network_fixture.h"
#include "study/model_ring.h"

namespace limb_ring::study {
namespace {

constexpr unsigned kNodes = 16;
const Medium kOurRing = gigabit(kNodes);
constexpr Duration T = 8ns * (512 + 12);

TEST(RingNetwork, MessageAloneTakesItsLengthAndARelayDelayPerHop) {
  for (unsigned hops = 1; hops < kNodes; ++hops) {
    const auto destination = static_cast<NodeId>((3 + hops) % kNodes);
    EXPECT_EQ(delivery(RingNetwork(), kOurRing, data(0ns, 3, destination, 512)), T + hops * d);
  }
}

// Round trip N * T + d: each node first sends its own, then relays; so h * T + d after h hops.
TEST(RingNetwork, AllAtOnceQueueBehindEachNodesOwn) {
  for (const unsigned hops : {1u, 8u, 15u}) {
    const Duration after = hops * T + d;
    EXPECT_THAT(deliveries(RingNetwork(), kOurRing, all_to(kOurRing, hops)), testing::Each(after)) << hops;
  }
}

TEST(RingNetwork, TimeZeroIsTheCallersOwn) {
  EXPECT_EQ(delivery(RingNetwork(), kOurRing, data(1ms, 0, 1, 512)), 1ms + T + d);
}

TEST(RingNetwork, InterruptIsEmbedded) {
  EXPECT_EQ(delivery(RingNetwork(), kOurRing, interrupt(0ns, 3, 9)), 96ns + 6 * d);
  // 1 us into a packet: at the next word boundary, 32 ns a word, then without waiting for its end.
  const auto at = deliveries(RingNetwork(), kOurRing, {data(0ns, 3, 9, 512), interrupt(1us, 3, 9)});
  EXPECT_LE(at[1], 1us + 32ns + 96ns + 6 * d);
}

TEST(RingNetwork, HigherPriorityOvertakesInItsNode) {
  const auto at =
      deliveries(RingNetwork(), kOurRing, {data(0ns, 0, 1, 512, 3), data(1ns, 0, 1, 512, 3), data(2ns, 0, 1, 512, 0)});
  EXPECT_LT(at[0], at[2]);
  EXPECT_LT(at[2], at[1]);
}

// More than any queue of a node holds: what waits outside keeps its order.
TEST(RingNetwork, NoMessageIsRefusedForLackOfQueueSpace) {
  std::vector<Message> messages;
  for (unsigned i = 0; i < 200; ++i) messages.push_back(data(0ns, 0, 1, 512));
  const auto at = deliveries(RingNetwork(), kOurRing, messages);
  for (unsigned i = 0; i < 200; ++i) EXPECT_EQ(at[i], i * (T + kNodes * d) + T + d) << i;
}

TEST(RingNetwork, MessageThatComesTooLateIsNotDelivered) {
  EXPECT_THAT(RingNetwork().carry(kOurRing, {data(0ns, 0, 1, 512), data(0ns, 0, 2, 512)}, Time{} + T + d),
              testing::ElementsAre(Time{} + T + d, core::kNever));
}

TEST(RingNetwork, ReportsProgressWhileItRuns) {
  unsigned told = 0;
  const RingNetwork network([&told] { ++told; });
  std::vector<Message> messages;
  for (unsigned i = 0; i < 1000; ++i) messages.push_back(data(0ns, 0, 1, 512));
  deliveries(network, kOurRing, messages);
  EXPECT_GT(told, 1u);
}

// At least the hello's way round; at most a time-out of two worst laps, where it is lost, and a lap.
TEST(RingNetwork, NewNodeMaySendOnceItsHelloIsHome) {
  const Duration join = RingNetwork().time_to_join(kOurRing);
  EXPECT_GT(join, (kNodes + 1) * d);
  EXPECT_LT(join, 3 * (kNodes + 1) * (T + d));
}

}  // namespace

// The bounds that the pictures draw: protocol.md section 7.2, by hand.

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
