// Which pins a node has to pull, as the soak judges it.
#include "judge/sent_judge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/node_literal.h"

namespace limb_ring::sim {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr wire::Factor kFactor{2};
constexpr core::Time kThen{1us};

struct DuePinsOfNode : testing::Test {
  void put(bool sure, core::Time at = kThen) { due.put(0_id, kFactor, at, sure); }
  void pulled(core::Time at = kThen) { due.pulled({kFactor, 0_id}, at); }
  void time_goes_on() { due.judge(kThen + 1us); }

  std::vector<std::string> complaints;
  Complain complain = [this](Promise, const std::string& what) { complaints.push_back(what); };
  DuePins due{1_id, complain};
};

TEST_F(DuePinsOfNode, PulledOnceIsRight) {
  put(true);
  pulled();
  time_goes_on();
  EXPECT_THAT(complaints, IsEmpty());
}

TEST_F(DuePinsOfNode, NotPulledIsWrongIfItIsSure) {
  put(true);
  due.judge(kThen);
  EXPECT_THAT(complaints, IsEmpty()) << "it may still be pulled in this instant";
  time_goes_on();
  EXPECT_THAT(complaints, ElementsAre(HasSubstr("did not pull pin 2")));
}

TEST_F(DuePinsOfNode, MayBeLeftOutIfItIsNotSure) {
  put(false);
  time_goes_on();
  EXPECT_THAT(complaints, IsEmpty());
}

TEST_F(DuePinsOfNode, PulledTwiceIsWrong) {
  put(true);
  pulled();
  pulled();
  EXPECT_THAT(complaints, ElementsAre(HasSubstr("no new INTP")));
}

TEST_F(DuePinsOfNode, PulledAtAnotherTimeIsWrong) {
  put(true);
  pulled(kThen - 1ns);
  EXPECT_THAT(complaints, ElementsAre(HasSubstr("no new INTP")));
}

TEST_F(DuePinsOfNode, OnePullOfTwoIsOfTheOneThatMustBe) {
  put(false);
  put(true);
  pulled();
  time_goes_on();
  EXPECT_THAT(complaints, IsEmpty());
}

TEST_F(DuePinsOfNode, BothOfTwoMayBePulled) {
  put(false);
  put(true);
  pulled();
  pulled();
  time_goes_on();
  EXPECT_THAT(complaints, IsEmpty());
}

}  // namespace
}  // namespace limb_ring::sim
