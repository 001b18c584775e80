#include "link/head.h"

#include <gmock/gmock.h>

#include "link/endpoint.h"

namespace limb_ring::link {
namespace {

Head example() {
  Head head;
  head.type = HeadType::refuse;
  head.ring = 0x0102030405060708;
  head.session = 0x1112131415161718;
  head.sequence = 0x21222324;
  head.sender = 254;
  head.refusal = Refusal::busy;
  return head;
}

TEST(Head, LooksOnTheWireAsDrawn) {
  EXPECT_THAT(encode(example()),
              testing::ElementsAre('L', 'R', 2, 3, 1, 2, 3, 4, 5, 6, 7, 8, 0x11, 0x12, 0x13, 0x14,
                                   0x15, 0x16, 0x17, 0x18, 0x21, 0x22, 0x23, 0x24, 254, 1));
}

TEST(Head, ComesBackFromItsBytes) {
  const auto bytes = encode(example());
  const auto head = parse_head({bytes.data(), bytes.size()});
  ASSERT_TRUE(head);
  EXPECT_EQ(encode(*head), bytes);
  EXPECT_EQ(head->session, example().session);
  EXPECT_EQ(head->refusal, Refusal::busy);
}

TEST(Head, IsRefusedWhereItIsShortOrOfAnotherKindOrVersion) {
  const auto good = encode(example());
  EXPECT_FALSE(parse_head({good.data(), good.size() - 1}));
  for (const std::size_t at : {0, 1, 2, 3, 25}) {
    auto bad = good;
    bad[at] = 200;
    EXPECT_FALSE(parse_head({bad.data(), bad.size()})) << "byte " << at;
  }
}

TEST(Head, OfAnotherVersionCanStillAskToConnectAndRefuseForThat) {
  Head head = example();
  head.version = 1;
  head.refusal = Refusal::wrong_version;
  for (const HeadType type : {HeadType::connect, HeadType::refuse}) {
    head.type = type;
    const auto bytes = encode(head);
    const auto read = parse_head({bytes.data(), bytes.size()});
    ASSERT_TRUE(read);
    EXPECT_EQ(read->version, 1);
    EXPECT_EQ(read->ring, head.ring);
    EXPECT_EQ(read->session, head.session);
  }
  head.type = HeadType::accept;
  const auto bytes = encode(head);
  EXPECT_FALSE(parse_head({bytes.data(), bytes.size()}));
}

TEST(Head, TellsPeopleWhichEndIsTheOlderOne) {
  Head refuse;
  refuse.refusal = Refusal::wrong_version;
  refuse.version = 1;
  EXPECT_EQ(reason_of(refuse), "protocol mismatch: peer speaks version 1, this is version 2; update it");
  refuse.version = 3;
  EXPECT_EQ(reason_of(refuse), "protocol mismatch: peer speaks version 3, this is version 2; update this node");
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
