// What is said of each node after a stop, out of the daemons' status rows.
#include "ring/known_stops.h"

#include <gmock/gmock.h>

#include "support/node_rows.h"

namespace limb_ring::ask {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

const std::vector<Node> kNodes{{0, "body"}, {1, "head"}, {2, "knee"}, {3, "foot"}, {4, "hand"}};

using test::node_row;

status::NodeRow row(const std::string& state, bool latched, std::optional<std::int64_t> pulled_ms) {
  status::NodeRow row;
  row.cpu.state = state;
  row.cpu.stop = status::Stop{latched, true, 1, pulled_ms};
  return row;
}

const Rows kRows{{0, row("running", true, 3)},
                 {1, row("running", false, 3)},    // it was told, and never says
                 {2, row("running", false, 900)},  // an earlier stop
                 {3, row("absent", false, 3)}};

TEST(KnownStops, SayOfEachNodeWhatIsKnown) {
  std::vector<std::string> states;
  for (const KnownStop& stop : known_stops(kNodes, kRows, 20ms)) states.emplace_back(to_string(stop.state));
  EXPECT_THAT(states, testing::ElementsAre("stopped", "told", "not_reached", "no_cpu", "unknown"));
}

TEST(KnownStops, OfACpuThatNeverLatchesAreNotWaitedFor) {
  Rows rows = kRows;
  EXPECT_TRUE(may_say_so(rows, {kNodes[1], StopState::told}));
  EXPECT_FALSE(may_say_so(rows, {kNodes[0], StopState::stopped}));
  rows[1].cpu.stop->latches = false;
  EXPECT_FALSE(may_say_so(rows, {kNodes[1], StopState::told}));
  EXPECT_FALSE(may_say_so(rows, {kNodes[4], StopState::unknown})) << "no beacon of it is heard";
}

status::NodeRow hears(bool latched, const char* cpu, int age_ms) {
  return node_row({{"heard", {{{"id", 4}, {"age_ms", age_ms}, {"cpu_state", cpu}, {"stop_latched", latched}}}}});
}

StopState of(const char* state, const char* kind, std::optional<std::int64_t> pulled_ms,
             bool process_is_stopped = false) {
  status::NodeRow told = row(state, false, pulled_ms);
  told.cpu.kind = kind;
  told.cpu.hung = process_is_stopped;
  return known_stops({{0, "body"}}, {{0, told}}, 20ms)[0].state;
}

// Whoever relies on a stop must not be told that all is well while a CPU hangs, or is about to run without it.
TEST(KnownStops, OfACpuThatHangsOrBootsAreNotEnough) {
  EXPECT_EQ(of("silent", "child", 3), StopState::silent);
  EXPECT_EQ(of("running", "attached", 3, true), StopState::silent);
  for (const char* state : {"booting", "absent", "failed"}) EXPECT_EQ(of(state, "child", 3), StopState::booting);
  EXPECT_EQ(of("absent", "child", std::nullopt), StopState::not_reached);
  EXPECT_EQ(of("absent", "attached", 3), StopState::no_cpu) << "whether one comes is not known";
  EXPECT_EQ(of("none", "none", 3), StopState::no_cpu);
  EXPECT_FALSE(all_told({{{0, "body"}, StopState::silent}}));
  EXPECT_FALSE(all_told({{{0, "body"}, StopState::booting}}));
}

KnownStop in_ring(std::uint8_t id, bool reached) {
  return {{id, "node" + std::to_string(id)}, reached ? StopState::stopped : StopState::not_reached};
}

std::optional<std::uint8_t> next(const std::vector<KnownStop>& stops, const std::set<std::uint8_t>& asked) {
  const auto node = next_to_ask(stops, asked);
  return node ? std::optional<std::uint8_t>(node->id) : std::nullopt;
}

TEST(KnownStops, TellFromWhereAStopReachesTheRestOfAChain) {
  const std::vector<KnownStop> behind_a_cut{in_ring(0, true), in_ring(1, true), in_ring(2, false), in_ring(3, false)};
  EXPECT_EQ(next(behind_a_cut, {0}), 2);
  const std::vector<KnownStop> before_the_sender{in_ring(0, false), in_ring(1, true), in_ring(2, true),
                                                 in_ring(3, false)};
  EXPECT_EQ(next(before_the_sender, {1}), 3) << "node3 is the first of the chain, node0 its second";
  EXPECT_EQ(next(before_the_sender, {1, 3}), 0);
  EXPECT_EQ(next(before_the_sender, {0, 1, 3}), std::nullopt) << "who has been asked is not asked again";
  EXPECT_EQ(next({in_ring(0, true), in_ring(1, true)}, {0}), std::nullopt);
  EXPECT_EQ(next({in_ring(0, false), in_ring(1, false)}, {}), 0);
}

TEST(KnownStops, ANodeIsReachedByThoseWhoseBeaconsItHears) {
  const auto hearing = [](const json& heard) { return node_row({{"heard", heard}}); };
  const Rows rows{
      {0, hearing(json::array())},
      {1, hearing({{{"id", 0}, {"age_ms", 50}}})},
      {2, hearing({{{"id", 0}, {"age_ms", 900}}, {{"id", 1}, {"age_ms", 90}}, {{"id", 7}, {"age_ms", 1}}})}};
  EXPECT_EQ(who_reaches(rows, 0), std::nullopt) << "the first of a chain";
  EXPECT_EQ(who_reaches(rows, 1), 0);
  EXPECT_EQ(who_reaches(rows, 2), 1) << "the newest of those that can be asked here";
  EXPECT_EQ(who_reaches(rows, 5), std::nullopt);
}

StopState of_hand(const status::NodeRow& body, bool delivered) {
  return known_stops({{4, "hand"}}, {{0, body}}, 20ms, delivered)[0].state;
}

TEST(KnownStops, OfANodeOnAnotherHostAreToldByItsBeacons) {
  EXPECT_EQ(of_hand(hears(true, "running", 50), false), StopState::stopped);
  EXPECT_EQ(of_hand(hears(false, "running", 50), true), StopState::told);
  EXPECT_EQ(of_hand(hears(false, "running", 50), false), StopState::unknown);
  EXPECT_EQ(of_hand(hears(false, "absent", 50), true), StopState::no_cpu);
  EXPECT_EQ(of_hand(hears(false, "silent", 50), true), StopState::silent);
  EXPECT_EQ(of_hand(hears(false, "failed", 50), true), StopState::booting);
  EXPECT_EQ(of_hand(hears(true, "running", 5000), true), StopState::unknown) << "it is not heard any more";
}

TEST(KnownStops, ASentenceNamesTheOthers) {
  EXPECT_EQ(sentence_of(known_stops(kNodes, kRows, 20ms)),
            "1 of 5 stopped; told, but the CPU does not say whether it has stopped: head; no CPU to stop: foot; "
            "not reached: knee; not known, the daemon does not answer: hand");
}

TEST(KnownStops, ASentenceSaysWhatACpuMayNotHaveDone) {
  EXPECT_EQ(sentence_of({{{0, "body"}, StopState::silent}, {{1, "head"}, StopState::booting}}),
            "0 of 2 stopped; told, but the CPU is silent and may not have stopped: body; "
            "the CPU did not run, and comes up without the stop: head");
}

TEST(KnownStops, AllAreListedIfNoneIsLeftOut) {
  EXPECT_FALSE(all_told(known_stops(kNodes, kRows, 20ms)));
  EXPECT_TRUE(all_told(known_stops({{0, "body"}, {1, "head"}, {3, "foot"}}, kRows, 20ms)));
}

TEST(KnownStops, OfAPinThatWasNeverPulledNothingWasReached) {
  const Rows rows{{0, row("running", false, std::nullopt)}};
  EXPECT_EQ(known_stops({{0, "body"}}, rows, 20ms)[0].state, StopState::not_reached);
}

// It has gone on for 300 ms while our clock went on for 20 ms.
TEST(KnownStops, OnAVirtualRingThatCatchesUpAreThoseOfTheNewestPull) {
  const Rows rows{{0, row("running", false, 310)}, {1, row("running", false, 300)}, {2, row("running", false, 900)}};
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
