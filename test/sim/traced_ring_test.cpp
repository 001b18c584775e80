// Why was it late: what is said of packets of virtual rings, where the true answer is known.
#include "wire/traced_ring.h"

#include <gmock/gmock.h>

#include <sstream>

#include "sim/planned_ring.h"
#include "study/cases.h"
#include "support/node_literal.h"
#include "wire/pcapng.h"

namespace limb_ring::study {
namespace {

using namespace std::chrono_literals;
using capture::Hop;
using capture::PacketTrace;
using capture::TracedRing;
using capture::TripEnd;
using std::chrono::nanoseconds;
using testing::IsEmpty;
using testing::SizeIs;

constexpr nanoseconds kDelay{512}, kByte{8};
constexpr nanoseconds kLength = 524 * kByte;  // T: 512 bytes of data at 1 Gbit/s
constexpr nanoseconds kToTail = 516 * kByte;  // from a packet's first slice to its last

std::vector<capture::SeenPacket> seen_in(const std::string& file) {
  std::istringstream in(file);
  capture::PcapngReader reader(in, "capture");
  std::vector<capture::SeenPacket> packets;
  while (const auto record = reader.next())
    if (const auto* packet = std::get_if<CapturedPacket>(&*record)) packets.push_back(capture::seen(*packet));
  return packets;
}

TracedRing traced_case(Case which, sim::CaptureAt at = sim::CaptureAt::inputs_and_outputs) {
  Medium medium;
  medium.nodes = 4;
  std::ostringstream file;
  run_case(which, medium, 1, {nullptr, &file, at});
  return TracedRing(seen_in(file.str()));
}

/// Four nodes that have joined and are quiet, captured from then on.
class CapturedRing {
 public:
  explicit CapturedRing(unsigned receive_buffers = 32) : ring_(options(receive_buffers)) {
    EXPECT_TRUE(ring_.join());
    ring_.run_for(1ms);
    watching_.emplace(ring_, file_, sim::plain_names(ring_.size()), sim::CaptureAt::inputs_and_outputs);
  }
  sim::VirtualRing& operator*() { return ring_; }
  sim::VirtualRing* operator->() { return &ring_; }
  TracedRing traced() const { return TracedRing(seen_in(file_.str())); }

 private:
  static sim::VirtualRingOptions options(unsigned receive_buffers) {
    sim::VirtualRingOptions options;
    options.byte_time = kByte;
    options.adjust = [receive_buffers](core::Settings& settings) {
      settings.beacon = core::Duration{0};
      settings.receive_buffers = receive_buffers;
    };
    return options;
  }
  sim::VirtualRing ring_;
  std::ostringstream file_;
  std::optional<sim::RingCapture> watching_;
};

PacketTrace slowest(const TracedRing& ring) {
  const auto trips = capture::choose_trips(ring, {});
  EXPECT_FALSE(trips.empty());
  return ring.trace(trips.front());
}

TEST(TracedRing, APacketAloneWaitsNowhere) {
  const TracedRing ring = traced_case(Case::alone);
  ASSERT_EQ(ring.trips(), 1u);
  EXPECT_EQ(ring.round_trip(0), 4 * kDelay + kToTail);
  const PacketTrace trace = ring.trace(0);
  ASSERT_THAT(trace.hops, SizeIs(5));
  EXPECT_EQ(trace.end, TripEnd::home);
  for (unsigned node = 1; node < 4; ++node) {
    EXPECT_EQ(trace.hops[node].node, node);
    EXPECT_EQ(trace.hops[node].waited(), 0ns);
    EXPECT_THAT(trace.hops[node].behind, IsEmpty());
  }
  EXPECT_TRUE(trace.hops[4].in->home());
}

TEST(TracedRing, InTheWorstCaseItWaitsAtEveryNodeForThatNodesOwnPacket) {
  const PacketTrace trace = slowest(traced_case(Case::adversarial));
  EXPECT_EQ(trace.source, 0);
  ASSERT_THAT(trace.hops, SizeIs(5));
  for (unsigned node = 1; node < 4; ++node) {
    const Hop& hop = trace.hops[node];
    EXPECT_EQ(hop.waited(), kLength);
    ASSERT_THAT(hop.behind, SizeIs(1));
    EXPECT_EQ(hop.behind[0].source, node);
    EXPECT_TRUE(hop.behind[0].info.own);
  }
  EXPECT_EQ(trace.waited(), 3 * kLength);
}

/// Every nanosecond of a round trip is a wait, a relay delay or its own length, and who waited has one in its way.
void expect_all_accounted_for(const TracedRing& ring) {
  constexpr std::size_t kSlowest = 1000;
  auto trips = capture::choose_trips(ring, {});
  ASSERT_GT(trips.size(), kSlowest);
  trips.resize(kSlowest);
  for (const std::size_t trip : trips) {
    const PacketTrace trace = ring.trace(trip);
    ASSERT_THAT(trace.hops, SizeIs(5));
    EXPECT_EQ(*ring.round_trip(trip), trace.waited() + 4 * kDelay + trace.hops.back().in->info.span);
    for (const Hop& hop : trace.hops) {
      EXPECT_EQ(hop.waited().value_or(0ns) > 0ns, !hop.behind.empty()) << "node " << int{hop.node};
    }
  }
}

TEST(TracedRing, AccountsForEveryNanosecondAtFullLoad) { expect_all_accounted_for(traced_case(Case::random)); }

TEST(TracedRing, AccountsForEveryNanosecondOfInterruptsUnderLoadToo) {
  expect_all_accounted_for(traced_case(Case::interrupt_bound));
}

TEST(TracedRing, NamesTheInterruptThatCutsIntoAPacketAndThePacketItWasIn) {
  CapturedRing ring;
  ring->send(0_id, 2_id, std::vector<std::uint8_t>(512));
  ring->run_for(1us);
  ring->interrupt(1_id, 3_id, 6);
  ring->run_for(1ms);
  const TracedRing traced = ring.traced();
  ASSERT_EQ(traced.trips(), 2u);
  const PacketTrace data = traced.trace(0), interrupt = traced.trace(1);
  ASSERT_THAT(data.hops[1].cut_by, SizeIs(1));
  const capture::SeenPacket& cut = data.hops[1].cut_by[0];
  EXPECT_EQ(cut.source, 1);
  EXPECT_TRUE(cut.info.own);
  EXPECT_EQ(cut.began - data.hops[1].out->began, 64 * kByte) << "the next word boundary, 488 ns after its header began";
  ASSERT_THAT(data.hops[0].cut_by, SizeIs(1)) << "round the ring it meets the same packet, still on its way out";
  EXPECT_FALSE(data.hops[0].cut_by[0].info.own);
  EXPECT_EQ(interrupt.trailer->last, 6);
  EXPECT_EQ(interrupt.hops[0].out->info.carrier_source, 0);
}

TEST(TracedRing, ALostTryHasNoReturnAndTheRoundTripCountsFromIt) {
  CapturedRing ring;
  bool lost = false;
  ring->tap(2_id, [&lost](const wire::Slice& slice, core::Time, wire::SliceWriter& arriving) {
    if (lost) arriving.put(slice.kind, slice.bytes);
    lost = lost || slice.kind == wire::SliceKind::end;
  });
  ring->send(0_id, 1_id, {1, 2, 3, 4});
  ring->run_for(1s);
  const TracedRing traced = ring.traced();
  ASSERT_EQ(traced.trips(), 2u);
  EXPECT_FALSE(traced.round_trip(0));
  const PacketTrace again = traced.trace(1);
  EXPECT_EQ(again.end, TripEnd::home);
  ASSERT_THAT(again.earlier, SizeIs(1));
  EXPECT_EQ(again.earlier[0].end, TripEnd::not_home);
  EXPECT_EQ(again.earlier[0].last_seen.seen_by(), 2);
  EXPECT_FALSE(again.earlier[0].last_seen.info.input) << "out of it, and never into the next";
  EXPECT_EQ(traced.round_trip(1), again.ended - again.earlier[0].began);
}

TEST(TracedRing, ATryThatCameHomeDamagedIsCalledSo) {
  CapturedRing ring;
  bool damaged = false;
  ring->tap(3_id, [&damaged](const wire::Slice& slice, core::Time, wire::SliceWriter& arriving) {
    std::vector<std::uint8_t> bytes(slice.bytes.begin(), slice.bytes.end());
    if (!damaged && slice.kind == wire::SliceKind::end) bytes.back() ^= 1;
    damaged = damaged || slice.kind == wire::SliceKind::end;
    arriving.put(slice.kind, {bytes.data(), bytes.size()});
  });
  ring->send(0_id, 1_id, {1, 2, 3, 4});
  ring->run_for(1s);
  const PacketTrace again = slowest(ring.traced());
  ASSERT_THAT(again.earlier, SizeIs(1));
  EXPECT_EQ(again.earlier[0].end, TripEnd::damaged);
}

TEST(TracedRing, WhatWasRefusedIsToldAsWhatWentBefore) {
  CapturedRing ring(1);
  ring->set_cpu_reads(2_id, false);
  for (int i = 0; i < 2; ++i) ring->send(0_id, 2_id, {1});
  ring->run_for(100ms);
  const TracedRing traced = ring.traced();
  const PacketTrace last = traced.trace(traced.trips() - 1);
  EXPECT_EQ(last.end, TripEnd::refused);
  ASSERT_THAT(last.earlier, SizeIs(traced.trips() - 2)) << "all but the packet that was taken";
  EXPECT_EQ(last.earlier[0].end, TripEnd::refused);
}

TEST(TracedRing, WithoutOutputsNothingCanBeSaidOfWaits) {
  const TracedRing ring = traced_case(Case::alone, sim::CaptureAt::inputs);
  EXPECT_FALSE(ring.outputs_seen());
  EXPECT_FALSE(ring.round_trip(0));
}

TEST(TripChoice, TakesWhatIsSlowEnoughTheSlowestFirst) {
  const TracedRing ring = traced_case(Case::random);
  capture::TripChoice choice;
  const auto all = capture::choose_trips(ring, choice);
  choice.over = *ring.round_trip(all[all.size() / 2]);
  const auto slow = capture::choose_trips(ring, choice);
  ASSERT_FALSE(slow.empty());
  EXPECT_LE(slow.size(), all.size() / 2);
  EXPECT_EQ(slow.front(), all.front());
  EXPECT_GT(ring.round_trip(slow.back()), choice.over);
}

TEST(TripChoice, TakesBySourceSequenceAndTime) {
  const TracedRing ring = traced_case(Case::adversarial);
  for (wire::NodeId node{0}; node < 4; ++node) {
    capture::TripChoice choice;
    choice.source = node;
    ASSERT_THAT(capture::choose_trips(ring, choice), SizeIs(1));
    choice.sequence = static_cast<std::uint8_t>((wire::code_of(ring.first(0).code).sequence + 1) % 8);
    EXPECT_THAT(capture::choose_trips(ring, choice), IsEmpty());
  }
  capture::TripChoice choice;
  choice.at = ring.first(0).began;
  EXPECT_THAT(capture::choose_trips(ring, choice), SizeIs(1)) << "the others start later";
}

}  // namespace
}  // namespace limb_ring::study
