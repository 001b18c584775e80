// `ringctl record cause` on what a core broken on purpose has left in flight recorders: the events that it names are
// those that the planted fault needs, and to a sound core they do nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#include "judge/flight_recorder.h"
#include "judge/judged_ring.h"
#include "judge/recorded_lives.h"
#include "mutants/mutation.h"
#include "sim/recorded_story.h"
#include "sim/virtual_line_faults.h"
#include "wire/pcapng.h"

namespace limb_ring::sim {
namespace {

using core::Mutation;
using promises::Promise;
using namespace std::chrono_literals;

/// What goes wrong beside the core.
enum class Trouble { none, losses, damage, frozen, killed, unread };

struct Case {
  const char* name;
  Mutation mutation;
  Trouble trouble;
  Promise promise;
  const char* planted;  ///< one of the needed events has these words
  bool fold_back = false;
};

/// A ring with packets of all kinds, and its trouble.
class Traffic {
 public:
  Traffic(Trouble trouble, bool fold_back) : trouble_(trouble), ring_(options(fold_back)), recorded_(ring_) {
    ring_.join();
    for (const wire::NodeId id : ring_.order())
      ring_.tap(id,
                [this](const wire::Slice& slice, core::Time, wire::SliceWriter& arriving) { pass(slice, arriving); });
  }

  /// @param folder gets what flight recorders have left
  void record(const std::filesystem::path& folder) {
    constexpr int kTurns = 1500, kJudged = 300;  // until then the judge has not seen for long enough
    for (int turn = 0; turn < kTurns; ++turn) {
      disturbs_ = turn > kJudged;
      if (disturbs_ && turn % 100 == 0) disturb(turn % 200 == 0);
      send();
      ring_.run_for(20us);
    }
    write(folder);
  }

 private:
  static VirtualRingOptions options(bool fold_back) {
    VirtualRingOptions options;
    options.nodes = 5;
    options.keep_logs = false;
    options.adjust = [fold_back](core::Settings& settings) { set_short_times(settings, false, fold_back); };
    return options;
  }
  void pass(const wire::Slice& slice, wire::SliceWriter& arriving) {
    const bool hit = disturbs_ && is_traffic(slice) && random_() % 40 == 0;
    if (hit && trouble_ == Trouble::losses) return;
    const std::size_t before = arriving.view().size;
    arriving.put(slice.kind, slice.bytes);
    if (!hit || trouble_ != Trouble::damage || slice.kind != wire::SliceKind::whole) return;
    const std::size_t data = before + wire::kSliceHeaderSize + wire::kHeaderSize;
    const_cast<std::uint8_t*>(arriving.view().data)[data] ^= 0x10;
  }
  void disturb(bool begins) {
    constexpr wire::NodeId kNode{3}, kSource{2};
    if (trouble_ == Trouble::unread) ring_.set_cpu_reads(kNode, !begins);
    if (trouble_ == Trouble::frozen) begins ? ring_.freeze(kNode) : ring_.thaw(kNode);
    if (trouble_ == Trouble::killed) begins ? kill_sending(kSource) : ring_.start(kSource);
  }
  /// Its packet is under way then.
  void kill_sending(wire::NodeId node) {
    ring_.send(node, wire::kBroadcast, {1, 2, 3});
    ring_.run_for(1us);
    ring_.kill(node);
  }
  void send() {
    const wire::NodeId from{static_cast<std::uint8_t>(random_() % 3)};
    wire::NodeId to{static_cast<std::uint8_t>(random_() % 5)};
    if (random_() % 4 == 0) to = wire::kBroadcast;
    const std::uint32_t number = ++number_;
    if (!ring_.alive(from)) return;
    ring_.send(from, to, {std::uint8_t(number), std::uint8_t(number >> 8)}, random_() % 4);
    if (random_() % 4 == 0) ring_.interrupt(from, to, static_cast<std::uint8_t>(random_() % 8));
  }
  void write(const std::filesystem::path& folder) {
    unsigned id = 0;
    for (const auto& saved : recorded_.end_all()) {
      std::ofstream out(recorder::recording_of(folder.string(), id++), std::ios::binary);
      out.write(reinterpret_cast<const char*>(saved.data()), static_cast<std::streamsize>(saved.size()));
    }
  }

  const Trouble trouble_;
  std::mt19937 random_{7};
  std::uint32_t number_ = 0;
  bool disturbs_ = false;
  VirtualRing ring_;
  recorder::RecordedLives recorded_;
};

struct RecordedCauses : testing::TestWithParam<Case> {
  RecordedCauses() { std::filesystem::create_directories(folder); }
  ~RecordedCauses() override {
    core::mutation = Mutation::none;
    std::filesystem::remove_all(folder);
  }

  RecordedStory recorded_story(Trouble trouble, bool fold_back) const {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    Traffic(trouble, fold_back).record(folder);
    return story_of(folder, {promises::JudgedRing::times(), 50us, 50us}, [](const std::string&) {});
  }
  const std::string folder =
      (std::filesystem::temp_directory_path() / ("recorded_cause" + std::to_string(::getpid()))).string();
};

std::vector<std::size_t> needed_of(const scenario::Cause& cause) {
  std::vector<std::size_t> events;
  for (const auto& needed : cause.needed) events.push_back(needed.event);
  return events;
}

TEST_P(RecordedCauses, areThePlantedOnes) {
  core::mutation = GetParam().mutation;
  const RecordedStory found = recorded_story(GetParam().trouble, GetParam().fold_back);
  ASSERT_TRUE(found.breach);
  EXPECT_EQ(found.breach->promise, GetParam().promise) << found.breach->what;
  ASSERT_NE(found.story, nullptr) << found.why_not << "\n" << found.breach->what;
  const scenario::Cause cause = scenario::cause_of(*found.story, [](std::size_t) {});
  SCOPED_TRACE(found.breach->what + "\n" + text_of(cause, *found.story));
  std::cout << found.breach->what + "\n" + text_of(cause, *found.story);
  std::string words;
  for (const std::size_t event : needed_of(cause)) words += found.story->words(event) + "\n";
  EXPECT_THAT(words, testing::ContainsRegex(GetParam().planted));
  EXPECT_LE(cause.needed.size(), 5u);
  EXPECT_TRUE(cause.sealed_by || cause.certain_from_start);
  EXPECT_TRUE(found.story->fails(needed_of(cause)));
  core::mutation = Mutation::none;
  EXPECT_FALSE(found.story->fails(needed_of(cause))) << "a sound core fails, too";
}

INSTANTIATE_TEST_SUITE_P(
    Each, RecordedCauses,
    testing::Values(
        Case{"ResultTwice", Mutation::result_twice, Trouble::none, Promise::one_result, "node . .* sends"},
        Case{"MissesBroadcasts", Mutation::misses_broadcasts, Trouble::none, Promise::true_result, "to all"},
        Case{"ForgetsDuplicates", Mutation::forgets_duplicates, Trouble::losses, Promise::exactly_once,
             "the line .* loses "},
        Case{"ForgetsDuplicatesInAFoldingRing", Mutation::forgets_duplicates, Trouble::losses, Promise::exactly_once,
             "the line .* loses ", true},
        Case{"TakesDamaged", Mutation::takes_damaged, Trouble::damage, Promise::true_result, "damages"},
        Case{"SaysDelivered", Mutation::says_delivered, Trouble::frozen, Promise::true_result,
             "to node 3|does nothing|loses its output"},
        Case{"RefusedGoesLast", Mutation::refused_goes_last, Trouble::unread, Promise::in_order, "takes nothing"}),
    [](const auto& one) { return one.param.name; });

// For a picture: those that nodes had at its begin, and what follows.
TEST_F(RecordedCauses, haveTheStatesOfAllNodes) {
  Traffic(Trouble::frozen, false).record(folder);
  std::stringstream out;
  capture_states(folder, 5ms, 30ms, out);
  capture::PcapngReader reader(out, "states");
  std::set<std::uint8_t> at_begin;
  unsigned later = 0;
  while (const auto record = reader.next()) {
    const auto* event = std::get_if<capture::CapturedEvent>(&*record);
    ASSERT_NE(event, nullptr);
    EXPECT_THAT(event->what, testing::HasSubstr(" -> "));
    EXPECT_LE(event->time_ns, 25'000'000);
    if (event->time_ns == 0) at_begin.insert(event->node);
    later += event->time_ns > 0 ? 1 : 0;
  }
  EXPECT_FALSE(at_begin.empty());
  EXPECT_GT(later, 0u);
}

using SoundCore = RecordedCauses;

TEST_F(SoundCore, breaksNothingSoThereIsNoCause) {
  for (const Trouble trouble : {Trouble::losses, Trouble::damage, Trouble::frozen, Trouble::killed, Trouble::unread}) {
    SCOPED_TRACE(static_cast<int>(trouble));
    const RecordedStory found = recorded_story(trouble, false);
    EXPECT_FALSE(found.breach) << found.breach->what;
    EXPECT_EQ(found.story, nullptr);
  }
}

}  // namespace
}  // namespace limb_ring::sim
