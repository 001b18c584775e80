// The bytes of protocol.md section 11, computed by this project's own encoders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/transmit/send_unit.h"
#include "io/link_header.h"
#include "support/node_literal.h"
#include "support/view.h"
#include "wire/control_message.h"
#include "wire/packet.h"
#include "wire/slice.h"

namespace limb_ring {
namespace {

using testing::ElementsAreArray;
using Bytes = std::vector<std::uint8_t>;
using test::view;

constexpr wire::NodeId kSource{3};
constexpr wire::NodeId kDestination{7};
constexpr std::uint64_t kBoot = 0x1880000000000001;
constexpr std::uint64_t kConnectorNumber = 0x12345678;
constexpr std::uint64_t kAcceptorNumber = 0x9ABCDEF0;

/// The bytes of the first code block behind the heading of that section; a bar separates fields for people.
Bytes example(const std::string& section) {
  std::ifstream page(LIMB_RING_PROTOCOL);
  std::string line;
  while (std::getline(page, line) && line.rfind("### " + section + " ", 0) != 0) {
  }
  while (std::getline(page, line) && line != "```") {
  }
  Bytes bytes;
  while (std::getline(page, line) && line != "```") {
    std::replace(line.begin(), line.end(), '|', ' ');
    std::istringstream words(line);
    for (std::string word; words >> word;) bytes.push_back(static_cast<std::uint8_t>(std::stoul(word, nullptr, 16)));
  }
  return bytes;
}

template <class Array>
Bytes bytes_of(const Array& array) {
  return {array.begin(), array.end()};
}

/// What a node puts onto the line.
Bytes sent(wire::Code code, wire::NodeId destination, std::uint8_t last, const Bytes& data) {
  core::Flight flight;
  std::copy(data.begin(), data.end(), flight.load(code, kSource, destination, last, data.size()));
  return bytes_of(flight.launch({}, {}));
}

Bytes datp(wire::NodeId destination, std::uint8_t sequence, std::uint8_t pri, const Bytes& data) {
  return sent({false, 0, wire::Sequence{sequence}, wire::incarnation_of(kBoot)}, destination, pri, data);
}

Bytes knee() {
  return datp(kDestination, 2, wire::pri_byte(wire::Priority{1}, wire::ChannelId{0}), {'k', 'n', 'e', 'e', '!'});
}

Bytes intp() { return sent({true, 0, {}, wire::incarnation_of(kBoot)}, kDestination, wire::Factor{0}, {}); }

Bytes control(std::uint8_t sequence, const Bytes& message) {
  return datp(wire::kBroadcast, sequence, wire::pri_byte(wire::Priority{0}, wire::id_of(wire::Channel::control)),
              message);
}

Bytes header(link::LinkHeaderType type, std::uint64_t session, std::uint32_t sequence) {
  link::LinkHeader header;
  header.type = type;
  header.ring = link::ring_hash("humanoid16");
  header.session = session;
  header.sequence = sequence;
  header.sender = kSource;
  return bytes_of(link::encode(header));
}

TEST(WorkedExample, TheTestReadsThePage) { EXPECT_EQ(example("11.3").size(), wire::kInterruptPacketSize); }

TEST(WorkedExample, Datp) { EXPECT_THAT(example("11.1"), ElementsAreArray(knee())); }

TEST(WorkedExample, DatpBehindRelays) {
  Bytes relayed = knee();
  wire::rewrite(relayed.data(), relayed.size(), 4, 32);
  EXPECT_THAT(example("11.2"), ElementsAreArray(relayed));
}

TEST(WorkedExample, Intp) { EXPECT_THAT(example("11.3"), ElementsAreArray(intp())); }

TEST(WorkedExample, DatpAsOneSlice) {
  wire::SliceWriter line;
  line.put(wire::SliceKind::whole, view(knee()));
  EXPECT_THAT(example("11.4"), ElementsAreArray(bytes_of(line.view())));
}

TEST(WorkedExample, DatpWithAnIntpEmbedded) {
  const Bytes packet = knee();
  wire::SliceWriter line;
  line.put(wire::SliceKind::start, view(packet).first(8));
  line.put(wire::SliceKind::interrupt, view(intp()));
  line.put(wire::SliceKind::end, view(packet).from(8));
  EXPECT_THAT(example("11.5"), ElementsAreArray(bytes_of(line.view())));
}

TEST(WorkedExample, Hello) {
  Bytes message(wire::kHelloSize);
  wire::encode(wire::Hello{kBoot, false}, message.data());
  EXPECT_THAT(example("11.6"), ElementsAreArray(control(0, message)));
}

TEST(WorkedExample, Beacon) {
  wire::Beacon beacon;
  beacon.boot = kBoot;
  beacon.cpu_boots = 1;
  beacon.cpu_state = wire::CpuState::running;
  beacon.cpu_silent_ms = 12;
  beacon.input = beacon.output = wire::LinkState::up;
  beacon.input_from = 2_id;
  beacon.output_to = 4_id;
  Bytes message(wire::kBeaconSize);
  wire::encode(beacon, message.data());
  EXPECT_THAT(example("11.7"), ElementsAreArray(control(1, message)));
}

TEST(WorkedExample, Connect) {
  EXPECT_THAT(example("11.8"), ElementsAreArray(header(link::LinkHeaderType::connect, kConnectorNumber << 32, 0)));
}

TEST(WorkedExample, FirstDatagramOfASession) {
  Bytes datagram = header(link::LinkHeaderType::slices, kConnectorNumber << 32 | kAcceptorNumber, 1);
  wire::SliceWriter line;
  line.put(wire::SliceKind::idle, {});
  datagram.insert(datagram.end(), line.view().begin(), line.view().end());
  EXPECT_THAT(example("11.9"), ElementsAreArray(datagram));
}

TEST(WorkedExample, FoldWord) {
  wire::SliceWriter line;
  wire::put(line, {wire::FoldWordKind::begin, 2_id});
  EXPECT_THAT(example("11.10"), ElementsAreArray(bytes_of(line.view())));
}

}  // namespace
}  // namespace limb_ring
