// What is said of each node after a stop, out of the daemons' status rows.
#include "ask/known_stops.h"

#include <gmock/gmock.h>

namespace limb_ring::ask {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

const std::vector<Node> kNodes{{0, "body"}, {1, "head"}, {2, "knee"}, {3, "foot"}, {4, "hand"}};

json row(const std::string& state, bool latched, const json& pulled_ms) {
  return {{"cpu", {{"state", state}, {"stop", {{"latched", latched}, {"pulled", 1}, {"pulled_ms", pulled_ms}}}}}};
}

const Rows kRows{{0, row("running", true, 3)},
                 {1, row("silent", false, 3)},     // hung: it was told, and does not say
                 {2, row("running", false, 900)},  // an earlier stop
                 {3, row("absent", false, 3)}};

TEST(KnownStops, SayOfEachNodeWhatIsKnown) {
  std::vector<std::string> states;
  for (const KnownStop& stop : known_stops(kNodes, kRows, 20ms)) states.emplace_back(to_string(stop.state));
  EXPECT_THAT(states, testing::ElementsAre("stopped", "told", "not_reached", "no_cpu", "unknown"));
}

TEST(KnownStops, ASentenceNamesTheOthers) {
  EXPECT_EQ(sentence_of(known_stops(kNodes, kRows, 20ms)),
            "1 of 5 stopped; told, but the CPU does not say whether it has stopped: head; no CPU to stop: foot; "
            "not reached: knee; not known, the daemon does not answer: hand");
}

TEST(KnownStops, AllAreToldWhereNoneIsLeftOut) {
  EXPECT_FALSE(all_told(known_stops(kNodes, kRows, 20ms)));
  EXPECT_TRUE(all_told(known_stops({{0, "body"}, {1, "head"}, {3, "foot"}}, kRows, 20ms)));
}

TEST(KnownStops, OfAPinThatWasNeverPulledNothingWasReached) {
  const Rows rows{{0, row("running", false, nullptr)}};
  EXPECT_EQ(known_stops({{0, "body"}}, rows, 20ms)[0].state, StopState::not_reached);
}

}  // namespace
}  // namespace limb_ring::ask
