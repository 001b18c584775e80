// Nothing leaves before it can: not before it has come in, not before it was allowed to.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using wire::SliceKind;

/// A line of 100 Mbit/s in, one of 1 Gbit/s out.
struct SlowLineIntoAFastOne : testing::Test {
  SoloNode solo{Duration{8ns}, [](Settings& s) { s.byte_time_in = Duration{80ns}; }};
  void SetUp() override {
    solo.join();
    solo.run_for(1ms);
    solo.line();
  }
};

TEST_F(SlowLineIntoAFastOne, AnInterruptsLastByteLeavesNoEarlierThanItCameIn) {
  solo.receive(SliceKind::interrupt, foreign_interrupt(0, 2, 1));
  const Duration lag = 12 * (80ns - 8ns);
  solo.run_for(lag - Duration{1});
  EXPECT_THAT(solo.line(), IsEmpty());
  solo.run_for(Duration{1});
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::interrupt));
}

TEST_F(SlowLineIntoAFastOne, ADataPacketsLastByteLeavesNoEarlierThanItCameIn) {
  const Bytes packet = Foreign{0, 2}.with(pattern(22));
  solo.receive(SliceKind::start, {packet.begin(), packet.begin() + 4});
  solo.run_for(4 * (80ns - 8ns) - Duration{1});
  EXPECT_THAT(solo.line(), IsEmpty()) << "its header is not in yet";
  solo.run_for(24 * Duration{80ns} - 4 * (80ns - 8ns) + Duration{1});
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::start));
  solo.receive(SliceKind::end, {packet.begin() + 4, packet.end()});
  const Duration lag = (2 + 8) * (80ns - 8ns);  // odd bytes, trailer and CRC
  solo.run_for(lag - Duration{1});
  EXPECT_THAT(solo.line(), IsEmpty());
  solo.run_for(Duration{1});
  EXPECT_THAT(solo.kinds(), ElementsAre(SliceKind::end));
}

// What waits while new numbers are agreed on was dated back to when it was asked for, and the packet after it began
// before the line was free.
struct ClosedGate : testing::Test {
  Settings settings;
  Counters counters;
  EventQueue events;
  const Time asked = Time{} + 10us, opened = Time{} + 50us;
};

TEST_F(ClosedGate, AnInterruptThatWaitedAsksForTheLineWhenItIsOpened) {
  InterruptUnit unit(settings, counters, events);
  ASSERT_EQ(unit.enqueue({1, 1, 2_id, wire::Factor{0}}, asked), Reject::none);
  EXPECT_EQ(unit.ready_at(), kNever);
  unit.set_gate(Gate::open, opened);
  EXPECT_EQ(unit.ready_at(), opened);
}

TEST_F(ClosedGate, DataThatWaitedAsksForTheLineWhenItIsOpened) {
  DataUnit unit(settings, counters, events);
  const Bytes data = text("x");
  ASSERT_EQ(unit.enqueue(send_of(1, 1, 2_id, data), asked), Reject::none);
  unit.set_gate(Gate::control, asked);
  EXPECT_EQ(unit.ready_at(), kNever);
  unit.set_gate(Gate::open, opened);
  EXPECT_EQ(unit.ready_at(), opened);
}

/// The line out of node 0 takes nothing while its sends are asked for.
struct HeldUp : testing::TestWithParam<VirtualRingOptions> {};

TEST_P(HeldUp, ARoundTripBeginsWhenThePacketLeaves) {
  VirtualRing ring(GetParam());
  ASSERT_TRUE(ring.join());
  const Duration alone = outcome_of(ring, 0_id, ring.send(0_id, 2_id, text("a"))).round_trip;
  const Duration interrupt_alone = outcome_of(ring, 0_id, ring.interrupt(0_id, 2_id, 0)).round_trip;
  ring.set_output_ready(0_id, false);
  const auto data = ring.send(0_id, 2_id, text("b"));
  ring.run_for(50us);
  ring.set_output_ready(0_id, true);
  EXPECT_EQ(outcome_of(ring, 0_id, data).round_trip, alone);
  ring.set_output_ready(0_id, false);
  const auto interrupt = ring.interrupt(0_id, 2_id, 0);
  ring.run_for(50us);
  ring.set_output_ready(0_id, true);
  EXPECT_EQ(outcome_of(ring, 0_id, interrupt).round_trip, interrupt_alone);
}

INSTANTIATE_TEST_SUITE_P(AnyLine, HeldUp, testing::Values(quick(3), gigabit(3)),
                         [](const auto& made) { return made.index == 0 ? "WithoutRate" : "OfOneGigabit"; });

}  // namespace
}  // namespace limb_ring::core
