#include "ros_bridge/topic_in.h"

#include <gtest/gtest.h>

namespace limb_ring::bridge {
namespace {

using Verdict = PublisherCheck::Verdict;

TEST(PublisherCheck, AsksNobodyIfNobodyHasEverPublished) {
  PublisherCheck check;
  EXPECT_FALSE(check.wants_look(0));
}

TEST(PublisherCheck, AsksOnceIfAPublisherCame) {
  PublisherCheck check;
  EXPECT_TRUE(check.wants_look(1));
  EXPECT_EQ(check.look(1, 1), Verdict::well);
  EXPECT_FALSE(check.wants_look(1));
}

TEST(PublisherCheck, RenewsASubscriptionThatHasLostItsPublisher) {
  PublisherCheck check;
  check.look(1, 1);
  check.heard();
  EXPECT_TRUE(check.wants_look(0));
  EXPECT_EQ(check.look(0, 0), Verdict::well) << "its last messages may still wait";
  EXPECT_TRUE(check.wants_look(0));
  EXPECT_EQ(check.look(0, 0), Verdict::renew) << "the next publisher may have another type";
  EXPECT_FALSE(check.wants_look(0));
}

TEST(PublisherCheck, RenewsOneThatHadAPublisherBetweenTwoLooks) {
  PublisherCheck check;
  check.heard();
  EXPECT_TRUE(check.wants_look(0));
  EXPECT_EQ(check.look(0, 0), Verdict::well);
  EXPECT_EQ(check.look(0, 0), Verdict::renew);
}

TEST(PublisherCheck, RenewsOneThatAPublisherRefusesAndNotOneThatIsJustBeingConnected) {
  PublisherCheck check;
  check.heard();
  EXPECT_EQ(check.look(1, 0), Verdict::well);
  EXPECT_TRUE(check.wants_look(0));
  EXPECT_EQ(check.look(1, 0), Verdict::renew);
}

TEST(PublisherCheck, WarnsOnceOfAPublisherThatIsNotConnectedWhileOthersAre) {
  PublisherCheck check;
  EXPECT_EQ(check.look(2, 1), Verdict::well);
  EXPECT_TRUE(check.wants_look(1)) << "it may have just come";
  EXPECT_EQ(check.look(2, 1), Verdict::warn);
  EXPECT_FALSE(check.wants_look(1));
  EXPECT_EQ(check.look(2, 1), Verdict::well);
  EXPECT_EQ(check.look(1, 1), Verdict::well);
  check.look(2, 1);
  EXPECT_EQ(check.look(2, 1), Verdict::warn) << "it has come once more";
}

}  // namespace
}  // namespace limb_ring::bridge
