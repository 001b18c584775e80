#include "node/cpu_status.h"

#include <gtest/gtest.h>

#include <optional>
#include <utility>

namespace limb_ring::runtime {
namespace {

using namespace std::chrono_literals;
using Time = event_loop::NodeClock::Time;

/// A clock that a test sets, with one timer.
class SetClock : public event_loop::NodeClock {
 public:
  Time now() const override { return now_; }
  std::int64_t wall_ns(Time when) override { return when.time_since_epoch().count(); }
  std::unique_ptr<event_loop::Timer> timer(std::function<void()> on_time) override {
    on_time_ = std::move(on_time);
    return std::make_unique<OnlyTimer>(due_);
  }

  void go_to(Time when) {
    while (due_ && *due_ <= when) {
      now_ = *std::exchange(due_, std::nullopt);
      on_time_();
    }
    now_ = when;
  }
  /// As if nobody had the processor until then.
  void jump_to(Time when) {
    now_ = when;
    if (due_ && *due_ <= when) {
      due_.reset();
      on_time_();
    }
  }

 private:
  class OnlyTimer : public event_loop::Timer {
   public:
    explicit OnlyTimer(std::optional<Time>& due) : due_(due) {}
    void expires_at(Time when) override { due_ = when; }
    void cancel() override { due_.reset(); }

   private:
    std::optional<Time>& due_;
  };

  Time now_{};
  std::optional<Time> due_;
  std::function<void()> on_time_;
};

class SilenceWatchTest : public ::testing::Test {
 protected:
  static Time at(std::chrono::milliseconds time) { return Time(time); }

  /// Not a moment earlier.
  void expect_silent_at(std::chrono::milliseconds time) {
    clock_.go_to(at(time - 1ms));
    EXPECT_FALSE(watch_.silent());
    clock_.go_to(at(time));
    EXPECT_TRUE(watch_.silent());
  }

  SetClock clock_;
  int told_ = 0;
  SilenceWatch watch_{clock_, [this] { ++told_; }};
};

TEST_F(SilenceWatchTest, WithoutAPromiseItIsNeverSilent) {
  watch_.begin(0ms);
  clock_.go_to(at(1h));
  EXPECT_FALSE(watch_.silent());
}

TEST_F(SilenceWatchTest, ItIsSilentAfterThreePeriods) {
  watch_.begin(10ms);
  expect_silent_at(30ms);
  EXPECT_EQ(watch_.silent_for(), 30ms);
  EXPECT_EQ(told_, 1);
}

TEST_F(SilenceWatchTest, EachWordGivesItThreePeriodsMore) {
  watch_.begin(10ms);
  clock_.go_to(at(25ms));
  EXPECT_FALSE(watch_.spoke(clock_.now())) << "it was not silent";
  expect_silent_at(55ms);
}

TEST_F(SilenceWatchTest, AWordEndsTheSilenceUntilTheNextOne) {
  watch_.begin(10ms);
  clock_.go_to(at(100ms));
  EXPECT_TRUE(watch_.spoke(clock_.now()));
  EXPECT_FALSE(watch_.silent());
  expect_silent_at(130ms);
  EXPECT_EQ(told_, 2);
}

TEST_F(SilenceWatchTest, ADaemonThatSleptDoesNotBlameTheCpu) {
  watch_.begin(40ms);
  clock_.jump_to(at(200ms));
  EXPECT_FALSE(watch_.silent());
  clock_.go_to(at(240ms));
  EXPECT_TRUE(watch_.silent()) << "it had another period";
}

TEST_F(SilenceWatchTest, OnceItHasEndedNobodyFallsSilent) {
  watch_.begin(10ms);
  watch_.end();
  clock_.go_to(at(1h));
  EXPECT_FALSE(watch_.silent());
  EXPECT_EQ(told_, 0);
}

TEST_F(SilenceWatchTest, TheNextCpuOwesNothingOfTheOneBefore) {
  watch_.begin(10ms);
  clock_.go_to(at(25ms));
  watch_.begin(0ms);
  EXPECT_EQ(watch_.silent_for(), 0ms);
  clock_.go_to(at(1h));
  EXPECT_FALSE(watch_.silent());
}

}  // namespace
}  // namespace limb_ring::runtime
