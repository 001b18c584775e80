// The figures of protocol.md section 7.2, each case under its own name.
#include "core/ring_fixture.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

constexpr unsigned kTimedNodes = 16;
const Duration T = 8ns * (512 + 12);
const Duration d = 512ns;

struct Gigabit : testing::Test {
  VirtualRing ring{gigabit(kTimedNodes)};
  void SetUp() override {
    ASSERT_TRUE(ring.join());
    ring.run_for(1ms);
  }
};

TEST_F(Gigabit, AloneOnTheRing) {
  const auto token = ring.send(0_id, 8_id, Bytes(512));
  EXPECT_EQ(outcome_of(ring, 0_id, token).round_trip, T + kTimedNodes * d);
  EXPECT_EQ(T + kTimedNodes * d, 12384ns);
}

TEST_F(Gigabit, AllStartAtTheSameInstant) {
  std::vector<std::uint32_t> tokens;
  for (NodeId id{0}; id < kTimedNodes; ++id)
    tokens.push_back(ring.send(id, static_cast<NodeId>((id + 5) % kTimedNodes), Bytes(512)));
  for (NodeId id{0}; id < kTimedNodes; ++id) {
    const SendEnded end = outcome_of(ring, id, tokens[id]);
    EXPECT_EQ(end.outcome, Outcome::delivered);
    EXPECT_EQ(end.round_trip, kTimedNodes * T + d);
  }
  EXPECT_EQ(kTimedNodes * T + d, 67584ns);
}

// Every node starts its own packet just before ours arrives.
TEST_F(Gigabit, WorstCaseIsReached) {
  const Time start = ring.now();
  const auto token = ring.send(0_id, 8_id, Bytes(512));
  for (unsigned id = 1; id < kTimedNodes; ++id)
    ring.at(start + id * d + (id - 1) * T, [&, id] { ring.send(static_cast<NodeId>(id), 0_id, Bytes(512)); });
  EXPECT_EQ(outcome_of(ring, 0_id, token).round_trip, kTimedNodes * (T + d));
  EXPECT_EQ(kTimedNodes * (T + d), 75264ns);
}

TEST_F(Gigabit, InterruptAlone) {
  const auto token = ring.interrupt(3_id, 9_id, 1);
  EXPECT_EQ(outcome_of(ring, 3_id, token).round_trip, kTimedNodes * d + 96ns);
}

// Every node starts an interrupt of its own in the instant in which ours arrives.
TEST_F(Gigabit, InterruptBehindAnotherAtEveryNode) {
  const Time start = ring.now();
  const auto token = ring.interrupt(0_id, 8_id, 1);
  for (unsigned id = 1; id < kTimedNodes; ++id)
    ring.at(start + id * d + (id - 1) * 96ns, [&, id] { ring.interrupt(static_cast<NodeId>(id), 0_id, 1); });
  EXPECT_EQ(outcome_of(ring, 0_id, token).round_trip, kTimedNodes * (d + 96ns));
  EXPECT_EQ(kTimedNodes * (d + 96ns), 9728ns);
}

TEST_F(Gigabit, DeliveryDownstreamWithinItsBound) {
  std::vector<Time> arrived(kTimedNodes);
  ring.on_packet = [&](NodeId id, const ReceivedPacket& p) { arrived[id] = p.at; };
  const Time start = ring.now();
  const auto token = ring.send(0_id, wire::kBroadcast, Bytes(512));
  outcome_of(ring, 0_id, token);
  for (unsigned h = 1; h < kTimedNodes; ++h) EXPECT_EQ(arrived[h] - start, T + h * d) << h;
}

// All nodes always have something to send: line occupancy N*T/(N*T + d).
TEST_F(Gigabit, SaturatedAndAligned) {
  std::uint64_t laps = 0;
  ring.on_event = [&](NodeId id, const Event& event) {
    if (!std::holds_alternative<SendEnded>(event.what)) return;
    if (id == 0) ++laps;
    ring.send(id, static_cast<NodeId>((id + 1) % kTimedNodes), Bytes(512));
  };
  for (NodeId id{0}; id < kTimedNodes; ++id) ring.send(id, static_cast<NodeId>((id + 1) % kTimedNodes), Bytes(512));
  const Time start = ring.now();
  ring.run_for(1000 * (kTimedNodes * T + d));
  EXPECT_EQ(laps, 1000u);
  const double occupancy = static_cast<double>(laps) * (kTimedNodes * T).count() / (ring.now() - start).count();
  EXPECT_NEAR(occupancy, 0.9924, 0.00005);
}

}  // namespace
}  // namespace limb_ring::core
