#include <gmock/gmock.h>

#include <algorithm>

#include "io/link_header.h"
#include "io/link_rig.h"
#include "io/unix_line.h"

namespace limb_ring::link {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Node 1 with node 0 upstream; whatever an unknown peer does, that stays so.
struct UnknownPeer : testing::Test {
  /// The line is to stay up also if this process has to wait for its turn.
  static constexpr Timing kPatient{std::chrono::milliseconds(20), std::chrono::milliseconds(500)};
  LinkRig rig{2, Endpoint::Transport::unix_stream, kPatient};
  boost::asio::io_context io;

  void SetUp() override {
    rig.start_all();
    ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  }
  void TearDown() override {
    EXPECT_TRUE(rig.whole());
    EXPECT_THAT(rig.node(1).heard.log, ElementsAre("up 0"));
  }
  process::UniqueFd knock() { return connect_unix(rig.endpoint(1).path); }
  void say(process::UniqueFd& socket, const LinkHeader& header) {
    const auto bytes = encode_connect(header, {});
    const std::size_t size = header.version == kLinkVersion ? bytes.size() : kLinkHeaderSize;
    send_now(socket.get(), {bytes.data(), size});
  }
  std::uint64_t unknown_peers() { return rig.node(1).input->counters().unknown_peers; }
  /// The header that comes back; nothing if the line is closed without a word.
  std::optional<LinkHeader> answer(process::UniqueFd& socket) {
    std::array<std::uint8_t, kLinkHeaderSize> bytes;
    ssize_t got = -1;
    const bool came = rig.until([&] {
      got = receive_now(socket.get(), bytes.data(), bytes.size());
      return got >= 0;
    });
    EXPECT_TRUE(came) << "neither an answer nor an end";
    return parse_header({bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))});
  }
};

TEST_F(UnknownPeer, ThatTalksGarbageIsClosedAndCounted) {
  process::UniqueFd socket = knock();
  const std::string garbage(100, 'x');
  send_now(socket.get(), {reinterpret_cast<const std::uint8_t*>(garbage.data()), garbage.size()});
  ASSERT_TRUE(rig.until([&] { return unknown_peers() == 1; }));
  EXPECT_THAT(rig.node(1).input->last_unknown_peer(), HasSubstr("is not a limb_ring node"));
  EXPECT_THAT(rig.node(1).heard.unknown_peers, ElementsAre("peer is not a limb_ring node"));
}

TEST_F(UnknownPeer, ThatLeavesWithoutAWordIsCounted) {
  knock();
  EXPECT_TRUE(rig.until([&] { return unknown_peers() == 1; }));
}

TEST_F(UnknownPeer, ThatSaysNothingIsClosedInTime) {
  process::UniqueFd socket = knock();
  EXPECT_FALSE(answer(socket));
  EXPECT_EQ(unknown_peers(), 1u);
  EXPECT_THAT(rig.node(1).input->last_unknown_peer(), HasSubstr("did not say"));
}

TEST_F(UnknownPeer, OfAnotherRingIsToldSo) {
  process::UniqueFd socket = knock();
  LinkHeader header;
  header.type = LinkHeaderType::connect;
  header.ring = LinkRig::kRing + 1;
  say(socket, header);
  const auto answered = answer(socket);
  ASSERT_TRUE(answered);
  EXPECT_EQ(answered->refusal, Refusal::wrong_ring);
  EXPECT_EQ(unknown_peers(), 1u);
}

TEST_F(UnknownPeer, OfAnotherVersionIsToldSoEachTimeAndItsOwnNodeOnce) {
  LinkHeader header;
  header.version = 1;
  header.type = LinkHeaderType::connect;
  header.ring = LinkRig::kRing;
  for (int i = 0; i < 3; ++i) {
    process::UniqueFd socket = knock();
    say(socket, header);
    const auto answered = answer(socket);
    ASSERT_TRUE(answered);
    EXPECT_EQ(answered->refusal, Refusal::wrong_version);
    EXPECT_EQ(answered->version, kLinkVersion);
  }
  EXPECT_EQ(unknown_peers(), 3u);
  EXPECT_THAT(rig.node(1).heard.unknown_peers,
              ElementsAre("node 0: protocol mismatch: peer speaks version 1, this is version 3; update it"));
}

TEST_F(UnknownPeer, OfNoNodeOfTheRingIsToldSo) {
  process::UniqueFd socket = knock();
  LinkHeader header;
  header.type = LinkHeaderType::connect;
  header.ring = LinkRig::kRing;
  header.sender = 77;
  say(socket, header);
  const auto answered = answer(socket);
  ASSERT_TRUE(answered);
  EXPECT_EQ(answered->refusal, Refusal::not_in_ring);
}

TEST_F(UnknownPeer, AsAFartherNodeIsToldThatWeAreBusy) {
  process::UniqueFd socket = knock();
  LinkHeader header;
  header.type = LinkHeaderType::connect;
  header.ring = LinkRig::kRing;
  header.sender = 1;  // we ourselves
  say(socket, header);
  const auto answered = answer(socket);
  ASSERT_TRUE(answered);
  EXPECT_EQ(answered->refusal, Refusal::busy);
  EXPECT_EQ(rig.node(1).input->counters().refused, 1u);
}

TEST_F(UnknownPeer, AmongManyKeepsNobodyOut) {
  std::vector<process::UniqueFd> crowd;
  for (int i = 0; i < 50; ++i) crowd.push_back(knock());
  ASSERT_TRUE(rig.until([&] { return unknown_peers() == 50; }));
}

TEST_F(UnknownPeer, WithADatagramSocketThatIsNotOursDoesNothing) {
  LinkRig udp(2, Endpoint::Transport::udp);
  udp.start_all();
  ASSERT_TRUE(udp.until([&] { return udp.whole(); }));
  UdpSocket socket = connect_udp(io, udp_address(udp.endpoint(1)));
  const std::string garbage(700, 'x');
  send_now(socket.native_handle(), {reinterpret_cast<const std::uint8_t*>(garbage.data()), garbage.size()});
  LinkHeader other;
  other.type = LinkHeaderType::connect;
  other.ring = LinkRig::kRing + 1;
  const auto bytes = encode_connect(other, {});
  send_now(socket.native_handle(), {bytes.data(), bytes.size()});
  EXPECT_TRUE(udp.until([&] { return udp.node(1).input->counters().unknown_peers == 2; }));
  EXPECT_TRUE(udp.whole());
  EXPECT_THAT(udp.node(1).heard.slices, IsEmpty());
  EXPECT_THAT(udp.node(1).heard.unknown_peers,
              ElementsAre("peer is not a limb_ring node", "node 0: it belongs to another ring"));
}

}  // namespace
}  // namespace limb_ring::link
