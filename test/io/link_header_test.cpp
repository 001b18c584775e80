#include "io/link_header.h"

#include <gmock/gmock.h>

namespace limb_ring::link {
namespace {

LinkHeader example() {
  LinkHeader header;
  header.type = LinkHeaderType::refuse;
  header.ring = 0x0102030405060708;
  header.session = 0x1112131415161718;
  header.sequence = 0x21222324;
  header.sender = 254;
  header.refusal = Refusal::busy;
  return header;
}

TEST(LinkHeader, LooksOnTheWireAsDrawn) {
  EXPECT_THAT(encode(example()), testing::ElementsAre('L', 'R', 3, 3, 1, 2, 3, 4, 5, 6, 7, 8, 0x11, 0x12, 0x13, 0x14,
                                                      0x15, 0x16, 0x17, 0x18, 0x21, 0x22, 0x23, 0x24, 254, 1));
}

TEST(LinkHeader, ComesBackFromItsBytes) {
  const auto bytes = encode(example());
  const auto header = parse_header({bytes.data(), bytes.size()});
  ASSERT_TRUE(header);
  EXPECT_EQ(encode(*header), bytes);
  EXPECT_EQ(header->session, example().session);
  EXPECT_EQ(header->refusal, Refusal::busy);
}

TEST(LinkHeader, IsRefusedIfItIsShortOrOfAnotherKindOrVersion) {
  const auto good = encode(example());
  EXPECT_FALSE(parse_header({good.data(), good.size() - 1}));
  for (const std::size_t at : {0, 1, 2, 3, 25}) {
    auto bad = good;
    bad[at] = 200;
    EXPECT_FALSE(parse_header({bad.data(), bad.size()})) << "byte " << at;
  }
}

TEST(LinkHeader, OfAnotherVersionCanStillAskToConnectAndRefuseForThat) {
  LinkHeader header = example();
  header.version = 1;
  header.refusal = Refusal::wrong_version;
  for (const LinkHeaderType type : {LinkHeaderType::connect, LinkHeaderType::refuse}) {
    header.type = type;
    const auto bytes = encode(header);
    const auto read = parse_header({bytes.data(), bytes.size()});
    ASSERT_TRUE(read);
    EXPECT_EQ(read->version, 1);
    EXPECT_EQ(read->ring, header.ring);
    EXPECT_EQ(read->session, header.session);
  }
  header.type = LinkHeaderType::accept;
  const auto bytes = encode(header);
  EXPECT_FALSE(parse_header({bytes.data(), bytes.size()}));
}

TEST(LinkHeader, TellsPeopleWhichEndIsTheOlderOne) {
  LinkHeader refuse;
  refuse.refusal = Refusal::wrong_version;
  refuse.version = 1;
  EXPECT_EQ(reason_of(refuse), "protocol mismatch: peer speaks version 1, this is version 3; update it");
  refuse.version = 4;
  EXPECT_EQ(reason_of(refuse), "protocol mismatch: peer speaks version 4, this is version 3; update this node");
  refuse.refusal = Refusal::closing;
  EXPECT_EQ(reason_of(refuse), "it is shutting down");
}

TEST(RingHash, IsFnv1aOf64Bits) {
  EXPECT_EQ(ring_hash(""), 0xCBF29CE484222325u);
  EXPECT_EQ(ring_hash("a"), 0xAF63DC4C8601EC8Cu);
  EXPECT_NE(ring_hash("left"), ring_hash("right"));
}

}  // namespace
}  // namespace limb_ring::link
