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

json hears(bool latched, const char* cpu, int age_ms) {
  json row = kRows.at(0);
  row["heard"] = {{{"id", 4}, {"age_ms", age_ms}, {"cpu_state", cpu}, {"stop_latched", latched}}};
  return row;
}

StopState of_hand(const json& body, bool delivered) {
  return known_stops({{4, "hand"}}, {{0, body}}, 20ms, delivered)[0].state;
}

TEST(KnownStops, OfANodeOnAnotherHostAreToldByItsBeacons) {
  EXPECT_EQ(of_hand(hears(true, "running", 50), false), StopState::stopped);
  EXPECT_EQ(of_hand(hears(false, "running", 50), true), StopState::told);
  EXPECT_EQ(of_hand(hears(false, "running", 50), false), StopState::unknown);
  EXPECT_EQ(of_hand(hears(false, "absent", 50), true), StopState::no_cpu);
  EXPECT_EQ(of_hand(hears(true, "running", 5000), true), StopState::unknown) << "it is not heard any more";
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

// It has gone on for 300 ms while our clock went on for 20 ms.
TEST(KnownStops, OnAVirtualRingThatCatchesUpAreThoseOfTheNewestPull) {
  const Rows rows{{0, row("running", false, 310)}, {1, row("silent", false, 300)}, {2, row("running", false, 900)}};
  const auto age = age_on_virtual_ring(rows, 20ms);
  EXPECT_EQ(age, 320ms);
  const auto stops = known_stops({{0, "body"}, {1, "head"}, {2, "knee"}}, rows, age);
  EXPECT_EQ(stops[0].state, StopState::told);
  EXPECT_EQ(stops[1].state, StopState::told);
  EXPECT_EQ(stops[2].state, StopState::not_reached);
  EXPECT_EQ(age_on_virtual_ring({}, 20ms), 20ms);
}

}  // namespace
}  // namespace limb_ring::ask
