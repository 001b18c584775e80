#include "limb_ring/payload/reassembler.h"

#include <gmock/gmock.h>

#include "client/hostile_bytes.h"
#include "limb_ring/payload/fragmenter.h"

namespace limb_ring::payload {
namespace {

using Packets = std::vector<Bytes>;
using Kind = Fragment::Kind;

Packets cut(Fragmenter& fragmenter, Kind kind, const Bytes& message) {
  EXPECT_TRUE(fragmenter.start(kind, message));
  Packets packets;
  while (!fragmenter.done()) packets.push_back(fragmenter.next());
  return packets;
}

Bytes pattern(std::size_t size, unsigned salt = 0) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i * 7 + i / 256 + salt);
  return bytes;
}

/// A sender of one topic, and where its packets come out.
class Topic {
 public:
  Topic(Reassembler& reassembler, std::uint8_t source, std::uint8_t topic)
      : reassembler_(reassembler), source_(source), fragmenter_(topic) {}

  Packets data(const Bytes& message) { return cut(fragmenter_, Kind::data, message); }
  Packets announcement(const Announcement& about = {"image", "sensor_msgs/Image", "md5", "text"}) {
    return cut(fragmenter_, Kind::announcement, *encode(about));
  }
  void announce() { deliver(announcement()); }
  /// @return the data messages completed
  std::vector<Bytes> deliver(const Packets& packets) {
    std::vector<Bytes> messages;
    for (const auto& packet : packets) {
      auto message = reassembler_.take(source_, view(packet));
      if (message && message->kind == Kind::data) messages.push_back(message->bytes);
    }
    return messages;
  }

 private:
  Reassembler& reassembler_;
  std::uint8_t source_;
  Fragmenter fragmenter_;
};

TEST(Reassembler, GivesBackMessagesOfEverySizeAroundThePacketBoundary) {
  Reassembler reassembler;
  Topic topic(reassembler, 1, 2);
  topic.announce();
  for (std::size_t size : {0, 1, 491, 492, 493, 983, 984, 985, 70000})
    EXPECT_THAT(topic.deliver(topic.data(pattern(size))), testing::ElementsAre(pattern(size)));
  EXPECT_EQ(reassembler.counters().messages, 9U);
}

TEST(Reassembler, GivesBackAnAnnouncementThatTookSeveralPackets) {
  Reassembler reassembler;
  Topic topic(reassembler, 1, 2);
  const Announcement about{"camera", "sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743", std::string(5000, 'd'),
                           true};
  EXPECT_EQ(reassembler.announcement(1, 2), nullptr);
  topic.deliver(topic.announcement(about));
  ASSERT_NE(reassembler.announcement(1, 2), nullptr);
  EXPECT_TRUE(*reassembler.announcement(1, 2) == about);
  EXPECT_EQ(reassembler.announcement(2, 2), nullptr);
  EXPECT_EQ(reassembler.counters().announcements, 1U);
}

TEST(Reassembler, DropsOnlyTheMessageThatLostAFragment) {
  for (std::size_t lost = 0; lost < 5; ++lost) {
    Reassembler reassembler;
    Topic topic(reassembler, 1, 2);
    topic.announce();
    auto first = topic.data(pattern(5 * kFragmentBytes));
    first.erase(first.begin() + static_cast<std::ptrdiff_t>(lost));
    EXPECT_TRUE(topic.deliver(first).empty()) << "without fragment " << lost;
    EXPECT_THAT(topic.deliver(topic.data(pattern(900, 1))), testing::ElementsAre(pattern(900, 1)));
    EXPECT_EQ(reassembler.counters().lost, 1U) << "without fragment " << lost;
    EXPECT_EQ(reassembler.held(), encode(*reassembler.announcement(1, 2))->size());
  }
}

TEST(Reassembler, IgnoresFragmentsThatComeTwice) {
  Reassembler reassembler;
  Topic topic(reassembler, 1, 2);
  topic.announce();
  Packets doubled;
  for (const auto& packet : topic.data(pattern(1400))) doubled.insert(doubled.end(), 2, packet);
  EXPECT_THAT(topic.deliver(doubled), testing::ElementsAre(pattern(1400)));
  EXPECT_EQ(reassembler.counters().duplicates, 3U);
  EXPECT_EQ(reassembler.counters().lost, 0U);
}

TEST(Reassembler, DoesNotGiveAWholeMessageTwice) {
  Reassembler reassembler;
  Topic topic(reassembler, 1, 2);
  topic.announce();
  const auto packets = topic.data(pattern(600));
  EXPECT_EQ(topic.deliver(packets).size(), 1U);
  EXPECT_TRUE(topic.deliver(packets).empty());
}

TEST(Reassembler, DropsAMessageWhoseFragmentsAreReordered) {
  Reassembler reassembler;
  Topic topic(reassembler, 1, 2);
  topic.announce();
  auto packets = topic.data(pattern(1400));
  std::swap(packets[1], packets[2]);
  EXPECT_TRUE(topic.deliver(packets).empty());
  EXPECT_EQ(reassembler.counters().lost, 1U);
  EXPECT_EQ(reassembler.counters().ignored, 1U);
}

TEST(Reassembler, DoesNotLetALateFragmentEndANewerMessage) {
  Reassembler reassembler;
  Topic topic(reassembler, 1, 2);
  topic.announce();
  const auto old = topic.data(pattern(600));
  topic.deliver(old);
  auto packets = topic.data(pattern(1400, 1));
  packets.insert(packets.begin() + 1, old[1]);
  EXPECT_THAT(topic.deliver(packets), testing::ElementsAre(pattern(1400, 1)));
}

TEST(Reassembler, KeepsTwoSourcesAndTwoTopicsApart) {
  Reassembler reassembler;
  Topic a(reassembler, 1, 2), b(reassembler, 3, 2), c(reassembler, 1, 4);
  for (Topic* topic : {&a, &b, &c}) topic->announce();
  const auto from_a = a.data(pattern(900, 1)), from_b = b.data(pattern(900, 2)), from_c = c.data(pattern(900, 3));
  for (Topic* topic : {&a, &b, &c}) {
    const auto& packets = topic == &a ? from_a : topic == &b ? from_b : from_c;
    EXPECT_TRUE(topic->deliver({packets[0]}).empty());
  }
  EXPECT_THAT(b.deliver({from_b[1]}), testing::ElementsAre(pattern(900, 2)));
  EXPECT_THAT(a.deliver({from_a[1]}), testing::ElementsAre(pattern(900, 1)));
  EXPECT_THAT(c.deliver({from_c[1]}), testing::ElementsAre(pattern(900, 3)));
}

TEST(Reassembler, DropsAndCountsDataThatNobodyAnnounced) {
  Reassembler reassembler;
  Topic topic(reassembler, 1, 2);
  EXPECT_TRUE(topic.deliver(topic.data(pattern(1400))).empty());
  EXPECT_EQ(reassembler.counters().unannounced, 1U);
  EXPECT_EQ(reassembler.held(), 0U);
  topic.announce();
  EXPECT_EQ(topic.deliver(topic.data(pattern(1400))).size(), 1U);
}

TEST(Reassembler, FollowsASenderThatRestartsAndAnnouncesAgain) {
  Reassembler reassembler;
  Topic before(reassembler, 1, 2);
  before.announce();
  for (int i = 0; i < 5; ++i) before.deliver(before.data(pattern(600)));
  before.deliver({before.data(pattern(1400))[0]});  // dies in the middle
  Topic after(reassembler, 1, 2);
  after.announce();
  EXPECT_THAT(after.deliver(after.data(pattern(700))), testing::ElementsAre(pattern(700)));
  EXPECT_EQ(reassembler.counters().lost, 1U);
}

TEST(Reassembler, FollowsASenderThatDiedWhileAnnouncing) {
  Reassembler reassembler;
  const Announcement about{"camera", "t", "m", std::string(2000, 'd')};
  Topic before(reassembler, 1, 2);
  const auto pieces = before.announcement(about);
  before.deliver({pieces[0], pieces[2]});  // one is lost, then the sender dies
  Topic after(reassembler, 1, 2);
  after.deliver(after.announcement(about));
  ASSERT_NE(reassembler.announcement(1, 2), nullptr);
  EXPECT_EQ(after.deliver(after.data(pattern(10))).size(), 1U);
}

TEST(Reassembler, TakesTheSameAnnouncementAgain) {
  Reassembler reassembler;
  for (int start = 0; start < 2; ++start) {
    Topic topic(reassembler, 1, 2);
    topic.announce();
    EXPECT_EQ(topic.deliver(topic.data(pattern(600))).size(), 1U);
  }
  EXPECT_EQ(reassembler.counters().announcements, 2U);
  EXPECT_EQ(reassembler.held(), encode(*reassembler.announcement(1, 2))->size());
}

TEST(Reassembler, DropsMessagesLongerThanItsLimit) {
  Reassembler reassembler({/*message=*/1000, /*total=*/100000});
  Topic topic(reassembler, 1, 2);
  topic.announce();
  EXPECT_TRUE(topic.deliver(topic.data(pattern(1001))).empty());
  EXPECT_EQ(topic.deliver(topic.data(pattern(1000))).size(), 1U);
  EXPECT_EQ(reassembler.counters().too_large, 1U);
}

TEST(Reassembler, NeverHoldsMoreThanItsLimitAndGivesUpTheLongestIdle) {
  Reassembler reassembler({/*message=*/1000, /*total=*/2500});
  for (std::uint8_t source = 0; source < 200; ++source) {
    Topic topic(reassembler, source, 0);
    topic.announce();
    topic.deliver({topic.data(pattern(1000))[0]});  // never finished
    ASSERT_LE(reassembler.held(), 2500U);
  }
  EXPECT_GT(reassembler.counters().evicted, 0U);
  EXPECT_GT(reassembler.counters().no_memory, 0U);  // in the end, announcements fill it
}

TEST(Reassembler, TakesALiveSendersMessagesAlthoughDeadSendersLeftFragments) {
  Reassembler reassembler({/*message=*/2000, /*total=*/5000});
  for (std::uint8_t source = 0; source < 10; ++source) {
    Topic dead(reassembler, source, 0);
    dead.announce();
    dead.deliver({dead.data(pattern(1900))[0]});
  }
  Topic living(reassembler, 99, 0);
  living.announce();
  EXPECT_EQ(living.deliver(living.data(pattern(1900))).size(), 1U);
}

TEST(Reassembler, FindsDamageThatNoPacketShows) {
  Reassembler reassembler;
  Topic topic(reassembler, 1, 2);
  topic.announce();
  auto packets = topic.data(pattern(1400));
  packets[1][kFragmentHeader + 3] ^= 1;
  EXPECT_TRUE(topic.deliver(packets).empty());
  EXPECT_EQ(reassembler.counters().corrupt, 1U);
}

TEST(Reassembler, CountsAMalformedAnnouncement) {
  Reassembler reassembler;
  Fragmenter fragmenter(2);
  for (const auto& packet : cut(fragmenter, Kind::announcement, {9, 9, 9}))
    EXPECT_FALSE(reassembler.take(1, view(packet)));
  EXPECT_EQ(reassembler.counters().corrupt, 1U);
  EXPECT_EQ(reassembler.announcement(1, 2), nullptr);
  EXPECT_EQ(reassembler.held(), 0U);
}

TEST(Reassembler, CountsPacketsThatAreNotFragments) {
  Reassembler reassembler;
  EXPECT_FALSE(reassembler.take(1, {}));
  EXPECT_FALSE(reassembler.take(1, view(Bytes(512, 0xAB))));
  EXPECT_EQ(reassembler.counters().malformed, 2U);
}

TEST(Reassembler, GivesOnlyMessagesThatWereSentWhateverIsLostDoubledOrSwapped) {
  const std::uint32_t seed = 99;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  Reassembler reassembler;
  Topic topic(reassembler, 1, 2);
  topic.announce();
  for (unsigned salt = 0; salt < 2000; ++salt) {
    const auto sent = pattern(random() % 3000, salt);
    auto packets = topic.data(sent);
    const auto at = static_cast<std::ptrdiff_t>(random() % packets.size());
    if (random() % 4 == 0) packets.insert(packets.begin() + at, packets[random() % packets.size()]);
    if (random() % 4 == 0) packets.erase(packets.begin() + at);
    if (packets.size() > 1 && random() % 4 == 0) std::swap(packets[0], packets[1]);
    const auto messages = topic.deliver(packets);
    ASSERT_LE(messages.size(), 1U);
    if (!messages.empty()) {
      ASSERT_EQ(messages[0], sent);
    }
  }
  EXPECT_GT(reassembler.counters().messages, 500U);
  EXPECT_GT(reassembler.counters().lost, 100U);
}

}  // namespace
}  // namespace limb_ring::payload
