#include <gmock/gmock.h>

#include <stdexcept>
#include <thread>

#include "io/hand_made_datagram.h"
#include "io/link_header.h"
#include "io/link_rig.h"
#include "io/udp_socket.h"
#include "io/unix_line.h"

namespace limb_ring::link {
namespace {

using testing::ElementsAre;

/// Node 1's input on its socket, with this test as node 0 sending datagrams by hand.
struct UdpInputFromHand : testing::Test {
  explicit UdpInputFromHand(Timing timing = LinkRig::kQuick) : rig(3, Endpoint::Transport::udp, timing) {}
  LinkRig rig;
  boost::asio::io_context io;
  UdpSocket line{io};
  std::uint64_t session = 0;
  RecordingInput& heard = rig.node(1).heard;

  void SetUp() override {
    rig.start_input(1);
    line = connect_udp(io, udp_address(rig.endpoint(1)));
    session = ask_for_session(7);
    datagram(1, {});
    ASSERT_TRUE(rig.until([&] { return rig.node(1).input->from() == 0; }));
  }
  LinkHeader header(LinkHeaderType type, std::uint64_t number, std::uint8_t sender = 0) {
    return header_of(LinkRig::kRing, type, number, sender);
  }
  void send(const LinkHeader& header, wire::ByteView slices = {}) {
    const auto bytes = datagram_of(header, slices);
    ASSERT_EQ(send_now(line.native_handle(), {bytes.data(), bytes.size()}), static_cast<ssize_t>(bytes.size()));
  }
  /// A datagram of the session with one slice holding `value`, or an idle one.
  void datagram(std::uint32_t sequence, std::optional<std::uint8_t> value) {
    wire::SliceWriter writer;
    if (value) {
      put_whole(writer, 20, *value);
    } else {
      writer.put(wire::SliceKind::idle, {});
    }
    LinkHeader h = header(LinkHeaderType::slices, session);
    h.sequence = sequence;
    send(h, writer.view());
  }
  std::optional<LinkHeader> answer(LinkHeaderType wanted) {
    std::optional<LinkHeader> found;
    rig.until([&] {
      std::array<std::uint8_t, kLinkHeaderSize> bytes;
      const auto got = receive_now(line.native_handle(), bytes.data(), bytes.size());
      if (got > 0) found = parse_header({bytes.data(), static_cast<std::size_t>(got)});
      return found && found->type == wanted;
    });
    return found;
  }
  void forget_answers() {
    std::array<std::uint8_t, kLinkHeaderSize> bytes;
    while (receive_now(line.native_handle(), bytes.data(), bytes.size()) > 0) {
    }
  }
  std::uint64_t ask_for_session(std::uint32_t nonce) {
    send(header(LinkHeaderType::connect, std::uint64_t{nonce} << 32));
    const auto accept = answer(LinkHeaderType::accept);
    return accept ? accept->session : 0;
  }
  const InputCounters& counters() { return rig.node(1).input->counters(); }
  bool until_datagrams(std::uint64_t count) {
    return rig.until([&] { return counters().datagrams >= count; });
  }
  std::vector<std::uint8_t> values() {
    std::vector<std::uint8_t> all;
    for (const auto& slice : heard.slices) all.push_back(slice.front());
    return all;
  }
};

// A bye would have found no room either.
TEST_F(UdpInputFromHand, CountsAsGivenUpIfItStoodStillAndItsSocketOverflowed) {
  const auto began = Clock::now();
  for (std::uint32_t i = 0; i < 5000; ++i) datagram(2 + i, std::uint8_t{1});
  std::this_thread::sleep_until(began + LinkRig::kQuick.silence);
  ASSERT_TRUE(rig.until([&] { return !rig.node(1).input->up(); }));
  EXPECT_EQ(counters().given_up, 1u);
  EXPECT_GT(counters().datagrams_stale, 0u);
  EXPECT_THAT(heard.slices, testing::IsEmpty());
}

/// It takes a burst without standing still, also on a busy machine.
struct PatientUdpInput : UdpInputFromHand {
  static constexpr Timing kPatient{milliseconds(20), milliseconds(600)};
  PatientUdpInput() : UdpInputFromHand(kPatient) {}
};

TEST_F(PatientUdpInput, StandsStillWithoutBeingGivenUpThoughItsSocketOverflowedLongBefore) {
  for (std::uint32_t i = 0; i < 5000; ++i) datagram(2 + i, std::uint8_t{1});
  std::uint32_t next = 6000;
  ASSERT_TRUE(rig.until([&] {
    datagram(next++, std::uint8_t{2});
    return counters().datagrams_lost > 0;
  }));
  forget_answers();
  ASSERT_TRUE(answer(LinkHeaderType::alive)) << "a tick since";
  ASSERT_EQ(counters().given_up, 0u) << "it has not stood still so far";
  datagram(next, std::uint8_t{3});
  std::this_thread::sleep_until(Clock::now() + kPatient.silence);
  ASSERT_TRUE(rig.until([&] { return values().back() == 3; }));
  EXPECT_EQ(counters().given_up, 0u);
  EXPECT_TRUE(rig.node(1).input->up());
}

TEST_F(UdpInputFromHand, TakesRunsOfDatagramsInFewerReadsIfTheKernelCan) {
  OutputCounters sent;
  UdpBatch batch({LinkRig::kRing, 0}, sent);
  batch.start_session(session);
  wire::SliceWriter writer;
  for (int i = 0; i < 30; ++i) put_whole(writer, 524, static_cast<std::uint8_t>(i));
  put_whole(writer, 20, 30);
  ASSERT_EQ(batch.send(line.native_handle(), writer.view()).taken, writer.view().size);
  ASSERT_TRUE(until_datagrams(32));
  ASSERT_EQ(heard.slices.size(), 30u);  // sequence 1 was the greeting's: discarded
  EXPECT_EQ(values().front(), 1);
  EXPECT_EQ(values().back(), 30);
  EXPECT_LE(sent.writes, 31u);
}

TEST_F(UdpInputFromHand, TakesTheSameDatagramsFromAKernelThatSendsThemSingly) {
  OutputCounters sent;
  UdpBatch batch({LinkRig::kRing, 0}, sent);
  batch.start_session(session);
  batch.send_singly();
  wire::SliceWriter writer;
  for (int i = 0; i < 5; ++i) put_whole(writer, 524, static_cast<std::uint8_t>(i));
  batch.send(line.native_handle(), writer.view());
  ASSERT_TRUE(until_datagrams(6));
  EXPECT_THAT(values(), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(sent.writes, 5u);
}

TEST(UdpInputAddress, ThatIsNotNumericIsRefused) {
  LinkRig rig(1, Endpoint::Transport::udp);
  InputSettings settings = rig.input_settings(0);
  settings.endpoint.address = "localhost";
  EXPECT_THROW(Input(rig.node(0).io, settings, rig.node(0).heard), std::runtime_error);
}

TEST(UdpInputAddress, ThatIsTakenIsRefused) {
  LinkRig rig(1, Endpoint::Transport::udp);
  rig.start_input(0);
  EXPECT_THROW(Input(rig.node(0).io, rig.input_settings(0), rig.node(0).heard), std::runtime_error);
}

}  // namespace
}  // namespace limb_ring::link
