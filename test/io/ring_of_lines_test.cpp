#include <gmock/gmock.h>

#include <algorithm>

#include "io/link_rig.h"

namespace limb_ring::link {
namespace {

using testing::ElementsAre;

using RingOfLinks = OnEveryTransport;
LIMB_RING_ON_EVERY_TRANSPORT(RingOfLinks);

TEST_P(RingOfLinks, ClosesInAnyOrderOfStarting) {
  std::vector<std::size_t> order{0, 1, 2, 3};
  do {
    LinkRig rig(4, GetParam());
    for (const std::size_t i : order) {
      rig.start(i);
      rig.run_for(milliseconds(1));
    }
    ASSERT_TRUE(rig.until([&] { return rig.whole(); })) << testing::PrintToString(order);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(rig.node(i).said.log.size(), 1u);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST_P(RingOfLinks, IsARingOfOneForTheFirstAndGrows) {
  LinkRig rig(3, GetParam());
  rig.start(1);
  ASSERT_TRUE(rig.until([&] { return rig.linked(1, 1); }));
  rig.start(0);
  ASSERT_TRUE(rig.until([&] { return rig.linked(0, 1) && rig.linked(1, 0); }));
  rig.start(2);
  EXPECT_TRUE(rig.until([&] { return rig.whole(); }));
}

TEST_P(RingOfLinks, CarriesSlicesInOrderAndWhole) {
  LinkRig rig(2, GetParam());
  rig.start_all();
  ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  std::size_t sent = 0;
  for (int batch = 0; batch < 50; ++batch) {
    wire::SliceWriter writer;
    for (int i = 0; i < 20; ++i, ++sent) {
      put_whole(writer, sent % 3 == 0 ? 13 + sent % 512 : 524, static_cast<std::uint8_t>(sent));
    }
    rig.node(0).output->write(writer.view());
    ASSERT_TRUE(rig.until([&] { return rig.node(1).heard.slices.size() == sent; }));
  }
  for (std::size_t i = 0; i < sent; ++i) {
    const auto& slice = rig.node(1).heard.slices[i];
    ASSERT_EQ(slice.size(), i % 3 == 0 ? 13 + i % 512 : 524);
    ASSERT_EQ(slice.front(), static_cast<std::uint8_t>(i));
    ASSERT_EQ(slice.back(), static_cast<std::uint8_t>(i));
  }
  EXPECT_EQ(rig.node(1).heard.log.front(), "up 0");
  EXPECT_EQ(std::count(rig.node(1).heard.log.begin(), rig.node(1).heard.log.end(), "gap"), 0);
}

TEST_P(RingOfLinks, HoldsAPacketOfEachNodeWhileTheOtherEndDoesNotRead) {
  LinkRig rig(2, GetParam());
  rig.start_all();
  ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  rig.node(1).frozen = true;
  // A socket of the largest ring, a queue of its own: see QueueMemory.HoldsAFullPacketOfEachNode for larger ones.
  const std::size_t packets = GetParam() == Endpoint::Transport::shm ? rig.size() : 254;
  wire::SliceWriter writer;
  for (std::size_t i = 0; i < packets; ++i) put_whole(writer, 524, static_cast<std::uint8_t>(i));
  rig.node(0).output->write(writer.view());
  EXPECT_TRUE(rig.node(0).output->ready());
  rig.node(1).frozen = false;
  EXPECT_TRUE(rig.until([&] { return rig.node(1).heard.slices.size() == packets; }));
}

TEST_P(RingOfLinks, StaysUpWhenQuietAndHandsNoIdleOn) {
  LinkRig rig(2, GetParam());
  rig.start_all();
  ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  const InputCounters& heard = rig.node(1).input->counters();
  ASSERT_TRUE(rig.until([&] { return heard.idle_slices + heard.beats > 20; }));
  EXPECT_THAT(rig.node(1).heard.log, ElementsAre("up 0"));
  EXPECT_THAT(rig.node(0).said.log, ElementsAre("up 1"));
}

TEST_P(RingOfLinks, SaysNothingAfterClosing) {
  LinkRig rig(2, GetParam());
  rig.start_all();
  ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  wire::SliceWriter writer;
  put_whole(writer, 524, 1);
  rig.node(0).output->write(writer.view());
  rig.node(1).input->close();
  rig.node(1).output->close();
  rig.run_for(milliseconds(100));
  EXPECT_THAT(rig.node(1).heard.log, ElementsAre("up 0"));
  EXPECT_THAT(rig.node(1).said.log, ElementsAre("up 0"));
  EXPECT_FALSE(rig.node(1).input->up());
  EXPECT_FALSE(rig.node(1).output->up());
}

TEST(MixedRing, ClosesOverUnixAndUdpLinks) {
  LinkRig unix_rig(3, Endpoint::Transport::unix_stream);
  LinkRig udp_rig(3, Endpoint::Transport::udp);
  // Node 1 listens on UDP, the others on UNIX sockets.
  for (std::size_t i = 0; i < 3; ++i) {
    RigNode& node = unix_rig.node(i);
    auto in = unix_rig.input_settings(i);
    if (i == 1) in.endpoint = udp_rig.endpoint(1);
    auto out = unix_rig.output_settings(i);
    for (Candidate& c : out.candidates) {
      if (c.id == 1) c.endpoint = udp_rig.endpoint(1);
    }
    node.input = std::make_unique<Input>(node.io, in, node.heard);
    node.output = std::make_unique<Output>(node.io, out, node.said);
  }
  EXPECT_TRUE(unix_rig.until([&] { return unix_rig.whole(); }));
}

}  // namespace
}  // namespace limb_ring::link
