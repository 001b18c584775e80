// A controller's state as bytes: another controller goes on from it. A number identifies its members.
#include "core/archive.h"

#include "core/copied_state.h"
#include "core/membership/peers.h"
#include "core/solo_node.h"

namespace limb_ring::core {
namespace {

template <class Value = std::uint8_t>
struct Member {
  const char* name;
  Value value;
  template <class Archive>
  void archive(Archive& a) {
    a(name, value);
  }
};

template <class Value>
std::uint64_t layout_of(Member<Value> member) {
  StateLayout layout;
  member.archive(layout);
  return layout.value();
}

TEST(StateLayout, DiffersWithANameButNotWithAValueOrThePlaceOfTheName) {
  const char here[] = "hop\0here", there[] = "hop\0there";
  EXPECT_EQ(layout_of(Member<>{here, 1}), layout_of(Member<>{there, 2}));
  EXPECT_NE(layout_of(Member<>{"hop", 1}), layout_of(Member<>{"hob", 1}));
}

TEST(StateLayout, DiffersWithASize) {
  EXPECT_NE(layout_of(Member<>{"hop", 1}), layout_of(Member<std::uint16_t>{"hop", 1}));
}

TEST(State, NeedsNoMoreRoomThanItTakes) {
  Member<std::uint32_t> member{"number", 7};
  std::array<std::uint8_t, 4> room{};
  StateWriter enough(room.data(), 4), too_little(room.data(), 3);
  member.archive(enough);
  member.archive(too_little);
  EXPECT_FALSE(enough.failed());
  EXPECT_TRUE(too_little.failed());
}

/// A line with what is to be written.
struct FilledLine {
  wire::SliceWriter line;
  template <class Archive>
  void archive(Archive& a) {
    a("line", line);
  }
};

TEST(State, HasTheSlicesThatAreNotYetWritten) {
  FilledLine before, after;
  const Bytes data = pattern(8);
  before.line.put(wire::SliceKind::more, {data.data(), data.size()});
  read_state(bytes_of(before), after);
  const wire::ByteView was = before.line.view(), is = after.line.view();
  EXPECT_EQ(Bytes(is.begin(), is.end()), Bytes(was.begin(), was.end()));
  EXPECT_FALSE(is.empty());
}

TEST(State, HasText) {
  Member<std::string> before{"name", "left_knee"}, after{"name", ""};
  read_state(bytes_of(before), after);
  EXPECT_EQ(after.value, "left_knee");
}

TEST(State, HasBits) {
  Member<std::bitset<3>> before{"bits", 5}, after{"bits", 0};
  read_state(bytes_of(before), after);
  EXPECT_EQ(after.value, 5);
  EXPECT_EQ(bytes_of(before).size(), 3u) << "a byte each";
}

TEST(State, ThatEndsInsideAByteViewIsRefused) {
  const Bytes data = pattern(4);
  Member<wire::ByteView> before{"data", {data.data(), data.size()}}, after{"data", {}};
  const Bytes whole = bytes_of(before);
  StateReader reader({whole.data(), whole.size() - 1});
  after.archive(reader);
  EXPECT_TRUE(reader.failed());
  EXPECT_TRUE(after.value.empty());
}

TEST(State, WithALengthBeyondItsEndIsRefusedBeforeMemoryIsReserved) {
  Member<std::vector<std::uint8_t>> before{"many", {1, 2, 3}}, after{"many", {}};
  const Bytes whole = bytes_of(before);
  StateReader reader({whole.data(), whole.size() - 1});
  after.archive(reader);
  EXPECT_TRUE(reader.failed());
  EXPECT_TRUE(after.value.empty());
}

TEST(State, ThatEndsInsideANumberIsRefused) {
  Member<std::uint32_t> before{"number", 0x01020304}, after{"number", 5};
  const Bytes whole = bytes_of(before);
  StateReader reader({whole.data(), whole.size() - 1});
  after.archive(reader);
  EXPECT_TRUE(reader.failed());
  EXPECT_EQ(after.value, 5u);
}

TEST(State, HasAllThatABeaconSaid) {
  wire::Beacon said{7,
                    1,
                    wire::CpuState::failed,
                    2,
                    wire::LinkState::up,
                    3_id,
                    wire::LinkState::folded,
                    4_id,
                    true,
                    5_id,
                    6_id,
                    false,
                    true,
                    {8, 9_id, 10}};
  wire::Beacon had;
  read_state(bytes_of(said), had);
  std::array<std::uint8_t, wire::kLongBeaconSize> first{}, second{};
  wire::encode(said, first.data());
  wire::encode(had, second.data());
  EXPECT_EQ(first, second);
}

TEST(State, HasTheBrokenLine) {
  wire::Beacon beacon;
  beacon.break_known = true;
  beacon.break_before = 5_id;
  beacon.break_behind = 6_id;
  KnownBreak before{1_id}, after{1_id};
  before.heard(beacon, 6_id);
  read_state(bytes_of(before), after);
  ASSERT_TRUE(after.line());
  EXPECT_EQ(after.line()->before, 5);
  EXPECT_EQ(after.line()->behind, 6);
}

TEST(State, HasThePacketThatIsComingIn) {
  SoloNode before;
  const Bytes packet = Foreign{0, 1}.with(pattern(22));
  before.join();
  before.receive(wire::SliceKind::start, {packet.begin(), packet.begin() + 4});
  before.line();
  Blocks after{before.node().settings()};
  read_state(bytes_of(before.node()), after);
  after.receive(Line::first, {wire::SliceKind::more, {packet.data() + 4, 20}}, before.now());
  after.receive(Line::first, {wire::SliceKind::end, {packet.data() + 24, packet.size() - 24}}, before.now());
  ReceivedPacket taken;
  ASSERT_TRUE(after.take(before.now(), taken));
  EXPECT_EQ(Bytes(taken.bytes().begin(), taken.bytes().end()), pattern(22));
}

TEST(State, HasThePacketThatIsComingInEvenIfItIsNoLongerPassedOn) {
  SoloNode before;
  const Bytes packet = Foreign{0, 1}.with(pattern(22));
  before.join();
  before.receive(wire::SliceKind::start, {packet.begin(), packet.begin() + 24});
  before.node().output_lost(before.now());
  Blocks after{before.node().settings()};
  read_state(bytes_of(before.node()), after);
  after.receive(Line::first, {wire::SliceKind::end, {packet.data() + 24, packet.size() - 24}}, before.now());
  ReceivedPacket taken;
  ASSERT_TRUE(after.take(before.now(), taken));
  EXPECT_EQ(Bytes(taken.bytes().begin(), taken.bytes().end()), pattern(22));
}

TEST(State, HasThePacketThatTheCpuHasNotTaken) {
  SoloNode before;
  before.join();
  before.receive(wire::SliceKind::whole,
                 Foreign{0, 1}.with_pri(wire::pri_byte(wire::Priority{2}, wire::ChannelId{5})).with(pattern(22)));
  before.run_for(1us);
  Blocks after{before.node().settings()};
  read_state(bytes_of(before.node()), after);
  ReceivedPacket taken;
  ASSERT_TRUE(after.take(before.now(), taken));
  EXPECT_EQ(taken.at, before.now() - 1us);
  EXPECT_EQ(taken.source, 0);
  EXPECT_EQ(taken.destination, 1);
  EXPECT_EQ(taken.priority, 2);
  EXPECT_EQ(taken.channel, 5);
  EXPECT_EQ(Bytes(taken.bytes().begin(), taken.bytes().end()), pattern(22));
}

TEST(State, HasTheEventsThatAreNotYetTaken) {
  EventQueue before, after;
  before.put(Time{}, BeaconHome{Duration{5us}});
  read_state(bytes_of(before), after);
  Event event;
  ASSERT_TRUE(after.take(Time{}, event));
  ASSERT_TRUE(std::holds_alternative<BeaconHome>(event.what));
  EXPECT_EQ(std::get<BeaconHome>(event.what).round_trip, Duration{5us});
}

TEST(State, HasThePinThatIsNotYetReported) {
  EventQueue before, after;
  before.put(Time{}, PinPulled{wire::Factor{3}, 7_id});
  read_state(bytes_of(before), after);
  Event event;
  ASSERT_TRUE(after.take(Time{}, event));
  EXPECT_EQ(std::get<PinPulled>(event.what).factor, 3);
  EXPECT_EQ(std::get<PinPulled>(event.what).source, 7);
}

TEST(State, HasTheNodeWhoseBeaconHasNews) {
  EventQueue before, after;
  before.put(Time{}, PeerChanged{7_id});
  read_state(bytes_of(before), after);
  Event event;
  ASSERT_TRUE(after.take(Time{}, event));
  EXPECT_EQ(std::get<PeerChanged>(event.what).node, 7);
}

TEST(State, HasAStateChangeThatIsNotYetTaken) {
  EventQueue before, after;
  before.put(Time{}, StateChanged{NodeState::joining, NodeState::open_chain});
  read_state(bytes_of(before), after);
  Event event;
  ASSERT_TRUE(after.take(Time{}, event));
  EXPECT_EQ(std::get<StateChanged>(event.what).before, NodeState::joining);
  EXPECT_EQ(std::get<StateChanged>(event.what).after, NodeState::open_chain);
}

TEST(SlotQueue, KeepsTheOrderOfWhatIsNotErased) {
  SlotQueue<int> queue;
  for (int i = 0; i < 6; ++i) queue.push() = i;
  queue.erase_if(1, [](int value) { return value % 3 == 1; });
  ASSERT_EQ(queue.size(), 4u);
  const int left[] = {0, 2, 3, 5};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(queue[i], left[i]);
}

}  // namespace
}  // namespace limb_ring::core
