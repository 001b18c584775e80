// Nodes come and go, and each knows the ring it is in.

#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::Each;
using testing::ElementsAre;

VirtualRingOptions talking(unsigned nodes) {
  VirtualRingOptions options = quick(nodes);
  options.adjust = [](Settings& s) { s.beacon = 100ms; };
  return options;
}

struct Membership16 : testing::Test {
  VirtualRing ring{talking(16)};

  void expect_ring_of(unsigned size) {
    for (unsigned id = 0; id < 16; ++id) {
      if (!ring.alive(static_cast<NodeId>(id))) continue;
      const Membership& m = ring.node(static_cast<NodeId>(id)).membership();
      EXPECT_EQ(m.state(), size == 1 ? NodeState::alone : NodeState::up) << id << " is " << to_string(m.state());
      EXPECT_EQ(m.ring_size(), size) << id;
    }
  }
  void expect_delivery(NodeId from, NodeId to) {
    EXPECT_EQ(outcome_of(ring, from, ring.send(from, to, text("alive"))).outcome, Outcome::delivered)
        << int{from} << " to " << int{to};
  }
};

TEST_F(Membership16, AllAtOnceJoinAndLearnTheSize) {
  ASSERT_TRUE(ring.join());
  expect_ring_of(16);
}

TEST_F(Membership16, HelloIsTheFirstPacketOfEveryNode) {
  VirtualRingOptions options = talking(3);
  options.start = false;
  VirtualRing three(options);
  std::vector<Bytes> first;
  for (NodeId id : {0_id, 1_id, 2_id}) {
    three.tap(id, [&first, id, seen = false](const wire::Slice& slice, Time, wire::SliceWriter& arriving) mutable {
      const wire::PacketFields packet{slice.bytes};
      if (!seen && packet.source() == id) first.emplace_back(packet.data().begin(), packet.data().end());
      seen = seen || packet.source() == id;
      arriving.put(slice.kind, slice.bytes);
    });
    three.start(id);
  }
  ASSERT_TRUE(three.join());
  ASSERT_EQ(first.size(), 3u);
  for (const Bytes& data : first) {
    const auto hello = wire::decode_hello({data.data(), data.size()});
    ASSERT_TRUE(hello);
    EXPECT_FALSE(hello->remembers) << "a node that starts has forgotten the others";
  }
}

TEST_F(Membership16, OneByOneInAnyOrderTheSizeFollows) {
  VirtualRingOptions options = talking(16);
  options.start = false;
  for (unsigned stride : {1u, 3u, 5u, 15u}) {
    VirtualRing growing(options);
    for (unsigned i = 0; i < 16; ++i) {
      growing.start(static_cast<NodeId>(i * stride % 16));
      ASSERT_TRUE(growing.join()) << stride << " " << i;
      growing.run_for(250ms);
      for (unsigned j = 0; j <= i; ++j) {
        const Membership& m = growing.node(static_cast<NodeId>(j * stride % 16)).membership();
        EXPECT_EQ(m.ring_size(), i + 1);
        EXPECT_EQ(m.state(), i == 0 ? NodeState::alone : NodeState::up);
      }
    }
  }
}

TEST_F(Membership16, EachNodeMayDieAndComeBack) {
  ASSERT_TRUE(ring.join());
  for (NodeId id{0}; id < 16; ++id) {
    ring.kill(id);
    ring.run_for(250ms);
    expect_ring_of(15);
    expect_delivery(static_cast<NodeId>((id + 15) % 16), static_cast<NodeId>((id + 1) % 16));
    ring.start(id);
    ASSERT_TRUE(ring.join());
    ring.run_for(250ms);
    expect_ring_of(16);
    expect_delivery(static_cast<NodeId>((id + 8) % 16), id);
    expect_delivery(id, static_cast<NodeId>((id + 8) % 16));
  }
}

TEST_F(Membership16, DownToTwoThenAloneAndBack) {
  ASSERT_TRUE(ring.join());
  for (NodeId id{2}; id < 16; ++id) ring.kill(id);
  ring.run_for(1s);
  expect_ring_of(2);
  expect_delivery(0_id, 1_id);
  expect_delivery(1_id, 0_id);
  ring.kill(1_id);
  ring.run_for(1s);
  expect_ring_of(1);
  expect_delivery(0_id, 0_id);
  EXPECT_EQ(outcome_of(ring, 0_id, ring.send(0_id, 1_id, text("a"))).outcome, Outcome::no_such_node);
  for (unsigned id = 15; id >= 1; --id) ring.start(static_cast<NodeId>(id));
  ASSERT_TRUE(ring.join());
  ring.run_for(250ms);
  expect_ring_of(16);
  expect_delivery(0_id, 15_id);
}

TEST_F(Membership16, AllMayRestartAtOnce) {
  ASSERT_TRUE(ring.join());
  for (NodeId id{0}; id < 16; ++id) ring.kill(id);
  ring.run_for(1s);
  for (NodeId id{0}; id < 16; ++id) ring.start(id);
  ASSERT_TRUE(ring.join());
  ring.run_for(250ms);
  expect_ring_of(16);
  expect_delivery(3_id, 2_id);
}

TEST_F(Membership16, HelloThatIsLostIsSaidAgain) {
  ring.tap(4_id, lose(4 * 16, is_data));
  ASSERT_TRUE(ring.join());
  EXPECT_GT(ring.counters(9_id).hellos, 1u);
  expect_ring_of(16);
}

TEST_F(Membership16, BeaconsCarryTheCpuToAllOthersAtOnce) {
  ASSERT_TRUE(ring.join());
  ring.run_for(10ms);
  ring.node(5_id).apply(input::Cpu{{3, wire::CpuState::running, true, ring.now(), false, {}}}, ring.now());
  ring.run_for(20us);
  for (NodeId id{0}; id < 16; ++id) {
    if (id == 5) continue;
    const Peer& peer = ring.node(id).membership().peers()[5_id];
    ASSERT_TRUE(peer.beacon_heard);
    EXPECT_EQ(peer.beacon.cpu_boots, 3u);
    EXPECT_EQ(peer.beacon.cpu_state, wire::CpuState::running);
    EXPECT_EQ(peer.hop, (id + 16 - 5 - 1) % 16);
    EXPECT_EQ(peer.beacon.input_from, 4);
    EXPECT_EQ(peer.beacon.output_to, 6);
  }
}

TEST_F(Membership16, ACpuThatHasSaidNothingHasNeitherStoppedNorStarted) {
  ASSERT_TRUE(ring.join());
  ring.run_for(250ms);
  const Peer& peer = ring.node(0_id).membership().peers()[5_id];
  ASSERT_TRUE(peer.beacon_heard);
  EXPECT_FALSE(peer.beacon.stop_latched);
  EXPECT_EQ(peer.beacon.cpu_boots, 0u);
  EXPECT_EQ(peer.beacon.cpu_state, wire::CpuState::none);
}

TEST_F(Membership16, BeaconsSayHowLongTheCpuHasBeenSilent) {
  ASSERT_TRUE(ring.join());
  ring.node(5_id).apply(input::Cpu{{1, wire::CpuState::running, true, ring.now(), false, {}}}, ring.now());
  ring.run_for(1s);
  EXPECT_NEAR(ring.node(0_id).membership().peers()[5_id].beacon.cpu_silent_ms, 950, 60);
}

TEST_F(Membership16, BeaconsComeEveryPeriodAndStopWithTheirNode) {
  ASSERT_TRUE(ring.join());
  ring.run_for(1s);
  ring.kill(5_id);
  ring.run_for(1s);
  const Membership& m = ring.node(0_id).membership();
  EXPECT_GE(ring.now() - m.peers()[5_id].heard_at, 990ms);
  EXPECT_LE(ring.now() - m.peers()[6_id].heard_at, 101ms);
}

TEST_F(Membership16, BeaconsOfNodesThatStartedAtDifferentTimesGoRoundTogether) {
  ASSERT_TRUE(ring.join());
  for (const NodeId late : {5_id, 9_id, 12_id}) {
    ring.kill(late);
    ring.run_for(37ms);
    ring.start(late);
  }
  ring.run_for(1s);
  Time first = kNever, last{};
  const auto& peers = ring.node(0_id).membership().peers();
  for (unsigned id = 1; id < 16; ++id) {
    first = std::min(first, peers[static_cast<NodeId>(id)].heard_at);
    last = std::max(last, peers[static_cast<NodeId>(id)].heard_at);
  }
  EXPECT_LE(last - first, 1ms);
}

// So that a quiet ring wakes each node twice for all of them: no timer but the first node's ends.
TEST_F(Membership16, TheFirstNodesBeaconTakesAllOthersAlong) {
  std::vector<NodeId> began;  // in this order
  for (const NodeId id : ring.order())
    ring.tap(id, [&began, id](const wire::Slice& slice, Time, wire::SliceWriter& arriving) {
      if (wire::PacketFields{slice.bytes}.source() == id) began.push_back(id);
      arriving.put(slice.kind, slice.bytes);
    });
  const auto begin_in = [&](Duration period) {
    began.clear();
    ring.run_for(period);
    return began;
  };
  ASSERT_TRUE(ring.join());
  ring.run_for(1050ms);
  std::vector<NodeId> all = ring.order();
  EXPECT_EQ(begin_in(100ms), all);
  ring.kill(0_id);
  ring.run_for(1050ms);
  all.erase(all.begin());
  EXPECT_EQ(begin_in(100ms + Duration(100ms) / 64), all);
}

TEST_F(Membership16, NewsIsAnEventAndRepetitionIsNot) {
  ASSERT_TRUE(ring.join());
  ring.run_for(500ms);
  const auto news = [&] {
    const auto& events = ring.log(0_id).events;
    return std::count_if(events.begin(), events.end(), [](const Event& e) {
      const auto* change = std::get_if<PeerChanged>(&e.what);
      return change && change->node == 5;
    });
  };
  const auto before = news();
  ring.run_for(500ms);
  EXPECT_EQ(news(), before);
  ring.node(5_id).apply(input::Cpu{{2, wire::CpuState::booting, true, ring.now(), false, {}}}, ring.now());
  ring.run_for(200ms);
  EXPECT_EQ(news(), before + 1);
}

TEST_F(Membership16, BeaconWaitingForTheLineDoesNotGoAheadOfANewHello) {
  ASSERT_TRUE(ring.join());
  ring.run_for(20ms);
  ring.kill(9_id);
  ring.run_for(5ms);
  for (int i = 0; i < 5; ++i) outcome_of(ring, 0_id, ring.send(0_id, 9_id, text("a")));
  ring.send(0_id, 9_id, text("the sixth"));
  ring.run_for(2us);
  ring.node(0_id).apply(input::Cpu{{9, wire::CpuState::running, true, ring.now(), false, {}}},
                        ring.now());  // a beacon waits
  std::vector<Bytes> sent;
  ring.tap(0_id, [&](const wire::Slice& slice, Time, wire::SliceWriter& arriving) {
    const wire::PacketFields packet{slice.bytes};
    if (packet.source() == 0) sent.emplace_back(packet.data().begin(), packet.data().end());
    arriving.put(slice.kind, slice.bytes);
  });
  ring.run_for(1ms);
  ASSERT_GE(sent.size(), 2u);
  EXPECT_TRUE(wire::decode_hello({sent[0].data(), sent[0].size()}).has_value());
  const auto beacon = wire::decode_beacon({sent[1].data(), sent[1].size()});
  ASSERT_TRUE(beacon.has_value());
  EXPECT_EQ(beacon->cpu_boots, 9u);
}

TEST(NodeStates, AreCalledAsInTheProtocol) {
  const std::pair<NodeState, const char*> kWords[] = {
      {NodeState::starting, "starting"},        {NodeState::joining, "joining"}, {NodeState::up, "up"},
      {NodeState::open_chain, "open_chain"},    {NodeState::folded, "folded"},   {NodeState::alone, "alone"},
      {NodeState::duplicate_id, "duplicate_id"}};
  for (const auto& [state, word] : kWords) EXPECT_STREQ(to_string(state), word);
}

}  // namespace
}  // namespace limb_ring::core
