#include <gmock/gmock.h>

#include <vector>

#include "core/events.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;

struct EventQueueAt100 : testing::Test {
  EventQueue queue;
  /// Tokens of results and the states behind changes that are due, in the order in which they are given out.
  std::vector<int> due(Time now) {
    std::vector<int> seen;
    for (Event event; queue.take(now, event);) {
      if (const auto* end = std::get_if<SendEnded>(&event.what)) seen.push_back(static_cast<int>(end->token));
      if (const auto* state = std::get_if<StateChanged>(&event.what)) seen.push_back(-static_cast<int>(state->after));
    }
    return seen;
  }
  static Time at(int ns) { return Time(std::chrono::nanoseconds(ns)); }
  static SendEnded end_of(std::uint32_t token) {
    SendEnded end;
    end.token = token;
    return end;
  }
};

TEST_F(EventQueueAt100, GivesOutWhatIsDueInTheOrderOfTime) {
  queue.put(at(140), end_of(1));
  queue.put(at(100), end_of(2));
  EXPECT_THAT(due(at(139)), ElementsAre(2));
  EXPECT_THAT(due(at(140)), ElementsAre(1));
}

// What a beacon said is shown with its last bit; the node has started over before that.
TEST_F(EventQueueAt100, ShowsStatesInTheirOrder) {
  queue.put(at(140), StateChanged{NodeState::joining, NodeState::open_chain});
  queue.put(at(140), end_of(1));
  queue.put(at(100), StateChanged{NodeState::open_chain, NodeState::starting});
  queue.put(at(100), StateChanged{NodeState::starting, NodeState::joining});
  EXPECT_THAT(due(at(100)), ElementsAre(-static_cast<int>(NodeState::open_chain),
                                        -static_cast<int>(NodeState::starting), -static_cast<int>(NodeState::joining)));
  EXPECT_THAT(due(at(140)), ElementsAre(1));
}

}  // namespace
}  // namespace limb_ring::core
