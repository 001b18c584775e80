#include "ros_bridge/topic_sender.h"

#include <gmock/gmock.h>

#include <numeric>

#include "limb_ring/payload/reassembler.h"

namespace limb_ring::bridge {
namespace {

using ::testing::ElementsAre;

constexpr std::uint8_t kSource = 2;
constexpr std::uint8_t kNumber = 5;

/// A sender, the ring as a list of what is under way, and the far side's reassembler.
class Topic : public ::testing::Test {
 protected:
  static config::TopicConfig frames() {
    config::TopicConfig topic;
    topic.input = "frames";
    topic.output = "far/frames";
    topic.to = 9;
    topic.priority = 3;
    topic.queue = 3;
    return topic;
  }
  TopicMessage message(std::size_t size, std::uint8_t fill, bool latching = false) const {
    return {{"", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data", latching},
            std::vector<std::uint8_t>(size, fill)};
  }
  /// Ends the oldest send; what was delivered is received.
  void answer(Outcome outcome, Reason why = {}) {
    auto [packet, done] = std::move(under_way.front());
    under_way.pop_front();
    if (outcome == Outcome::delivered) receive(packet);
    Result result;
    result.outcome = outcome;
    result.why = why;
    done(result);
  }
  void answer_all(Outcome outcome = Outcome::delivered) {
    while (!under_way.empty()) answer(outcome);
  }
  void receive(const Outgoing& packet) {
    const auto whole = far_side.take(kSource, {packet.data.data(), packet.data.size()});
    if (whole && whole->kind == payload::Fragment::Kind::data) received.push_back(whole->bytes);
  }
  static bool is_announcement(const Outgoing& packet) {
    payload::Reassembler fresh;
    const auto whole = fresh.take(kSource, {packet.data.data(), packet.data.size()});
    return whole && whole->kind == payload::Fragment::Kind::announcement;
  }
  std::uint64_t counted(const std::string& what) { return counters.all()["topic_frames_" + what]; }
  std::vector<std::uint8_t> first_bytes() const {
    std::vector<std::uint8_t> bytes;
    for (const auto& one : received) bytes.push_back(one.at(0));
    return bytes;
  }

  Counters counters;
  std::vector<std::size_t> too_large;
  std::deque<std::pair<Outgoing, RingPort::OnResult>> under_way;
  TopicSender sender{
      kNumber, frames(),
      [this](const Outgoing& packet, RingPort::OnResult done) { under_way.emplace_back(packet, std::move(done)); },
      [this](std::size_t bytes) { too_large.push_back(bytes); }, counters};
  payload::Reassembler far_side;
  std::vector<std::vector<std::uint8_t>> received;
};

TEST_F(Topic, AnnouncesItsTypeBeforeTheFirstMessage) {
  sender.offer(message(10, 'a'));
  ASSERT_EQ(under_way.size(), 1u);
  EXPECT_EQ(under_way.front().first.destination, 9);
  EXPECT_EQ(under_way.front().first.priority, 3);
  EXPECT_EQ(under_way.front().first.channel, payload::kTopicChannel);
  answer_all();
  const auto* type = far_side.announcement(kSource, kNumber);
  ASSERT_NE(type, nullptr);
  EXPECT_EQ(type->name, "far/frames");
  EXPECT_EQ(type->datatype, "std_msgs/String");
  EXPECT_THAT(first_bytes(), ElementsAre('a'));
  EXPECT_EQ(counted("sent"), 1u);
}

TEST_F(Topic, CrossesByteForByteInManyFragments) {
  auto large = message(70000, 0);
  std::iota(large.bytes.begin(), large.bytes.end(), std::uint8_t{0});
  sender.offer(large);
  answer_all();
  EXPECT_THAT(received, ElementsAre(large.bytes));
}

TEST_F(Topic, CrossesUpToTheLargestSizeAndTellsOfWhatIsLarger) {
  const std::size_t largest = TopicSender::kLargest;
  sender.offer(message(largest, 'a'));
  answer_all();
  EXPECT_EQ(counted("sent"), 1u);
  EXPECT_THAT(first_bytes(), ElementsAre('a'));
  sender.offer(message(largest + 1, 'b'));
  EXPECT_TRUE(under_way.empty()) << "nobody would put it together";
  EXPECT_THAT(too_large, ElementsAre(largest + 1));
  EXPECT_EQ(counted("dropped_too_large"), 1u);
  EXPECT_EQ(counted("sent"), 1u);
  sender.offer(message(1, 'c'));
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('a', 'c'));
}

TEST_F(Topic, NeverHasMoreThanItsWindowUnderWay) {
  sender.offer(message(70000, 'a'));
  std::size_t most = 0;
  while (!under_way.empty()) {
    most = std::max(most, under_way.size());
    answer(Outcome::delivered);
  }
  EXPECT_EQ(most, TopicSender::kWindow);
}

TEST_F(Topic, SendsSmallMessagesWithoutWaitingForEachOther) {
  sender.offer(message(1, 'a'));
  answer_all();
  sender.offer(message(1, 'b'));
  sender.offer(message(1, 'c'));
  EXPECT_EQ(under_way.size(), 2u);
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('a', 'b', 'c'));
}

TEST_F(Topic, DropsTheOldestWaitingMessageAtItsLimitAndCounts) {
  for (const char fill : {'a', 'b', 'c', 'd', 'e'}) sender.offer(message(1, fill));
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('c', 'd', 'e'));
  EXPECT_EQ(counted("dropped_queue"), 2u);
}

TEST_F(Topic, GivesUpAMessageWithALostFragmentAndGoesOnWithTheNext) {
  sender.offer(message(1, '-'));
  answer_all();
  sender.offer(message(7 * payload::kFragmentBytes, 'a'));
  sender.offer(message(1, 'b'));
  answer(Outcome::delivered);
  answer(Outcome::lost);
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('-', 'b'));
  EXPECT_EQ(counted("dropped_lost"), 1u);
  EXPECT_EQ(counted("sent"), 2u);
}

TEST_F(Topic, WaitsWhileNobodyTakesItsTypeAndAsksAgainWhenTold) {
  sender.offer(message(1, 'a'));
  answer(Outcome::no_such_node);
  EXPECT_TRUE(under_way.empty()) << "nothing is sent in vain";
  sender.announce();
  answer(Outcome::refused);
  sender.announce();
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('a'));
  EXPECT_EQ(counted("announcement_no_such_node"), 1u);
}

TEST_F(Topic, AnnouncesAgainAfterTheFarSideForgotIt) {
  sender.offer(message(1, 'a'));
  answer_all();
  far_side = payload::Reassembler();
  sender.announce();
  sender.offer(message(1, 'b'));
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('a', 'b'));
}

TEST_F(Topic, AnnouncesANewTypeBeforeItsFirstMessage) {
  sender.offer(message(1, 'a'));
  auto other = message(1, 'b');
  other.type.datatype = "std_msgs/Empty";
  sender.offer(other);
  answer_all();
  EXPECT_EQ(far_side.announcement(kSource, kNumber)->datatype, "std_msgs/Empty");
  EXPECT_THAT(first_bytes(), ElementsAre('a', 'b'));
}

TEST_F(Topic, OfTwoPublishersThatWordOneTypeDifferentlyIsAnnouncedOnce) {
  auto other = message(1, 'b');
  other.type.definition += '\n';
  unsigned announced = 0;
  const auto offer = [&](const TopicMessage& next) {
    sender.offer(next);
    for (; !under_way.empty(); answer(Outcome::delivered)) announced += is_announcement(under_way.front().first);
  };
  for (int i = 0; i < 3; ++i) {
    offer(message(1, 'a'));
    offer(other);
  }
  EXPECT_EQ(announced, 1u);
  EXPECT_EQ(far_side.announcement(kSource, kNumber)->definition, "string data");
  EXPECT_THAT(first_bytes(), ElementsAre('a', 'b', 'a', 'b', 'a', 'b'));
}

TEST_F(Topic, IsLatchedFromTheFirstPublisherOnThatLatches) {
  sender.offer(message(1, 'a'));
  answer_all();
  EXPECT_FALSE(far_side.announcement(kSource, kNumber)->latching);
  sender.offer(message(1, 'b', /*latching=*/true));
  answer_all();
  sender.offer(message(1, 'c'));
  answer_all();
  EXPECT_TRUE(far_side.announcement(kSource, kNumber)->latching);
  sender.far_side_restarted();
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('a', 'b', 'c', 'c'));
}

TEST_F(Topic, RepeatsALatchedMessageForAFarSideThatHasRestarted) {
  sender.offer(message(1, 'a', /*latching=*/true));
  answer_all();
  far_side = payload::Reassembler();
  sender.far_side_restarted();
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('a', 'a'));
  EXPECT_TRUE(far_side.announcement(kSource, kNumber)->latching);
}

TEST_F(Topic, WaitsWhileTheFarSideIsOutOfReachOfAnOpenChain) {
  sender.offer(message(1, 'a'));
  answer(Outcome::unconfirmed, Reason::out_of_reach);
  EXPECT_TRUE(under_way.empty()) << "nothing is sent in vain";
  sender.announce();
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('a'));
}

TEST_F(Topic, RepeatsALatchedMessageThatDidNotArrive) {
  sender.offer(message(1, 'a', /*latching=*/true));
  answer(Outcome::delivered);
  answer(Outcome::unconfirmed, Reason::out_of_reach);
  answer(Outcome::unconfirmed, Reason::out_of_reach);
  EXPECT_TRUE(under_way.empty()) << "nothing is sent in vain";
  sender.announce();
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('a'));
  EXPECT_EQ(counted("dropped_unconfirmed"), 1u);
  EXPECT_EQ(counted("sent"), 1u);
}

TEST_F(Topic, DoesNotRepeatALatchedMessageThatIsNotTheLast) {
  sender.offer(message(1, 'a', /*latching=*/true));
  answer(Outcome::delivered);
  sender.offer(message(1, 'b', /*latching=*/true));
  answer(Outcome::lost);
  answer_all();
  sender.announce();
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('b'));
}

TEST_F(Topic, DoesNotRepeatAMessageThatIsNotLatched) {
  sender.offer(message(1, 'a'));
  answer_all();
  sender.far_side_restarted();
  answer_all();
  EXPECT_THAT(first_bytes(), ElementsAre('a'));
}

}  // namespace
}  // namespace limb_ring::bridge
