// The judge of living and recorded rings finds what a core does that is broken on purpose, only from what is seen at
// the nodes. At a sound core it finds nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "judge/flight_recorder.h"
#include "judge/judged_ring.h"
#include "judge/recorded_lives.h"
#include "judge/replay.h"
#include "mutants/mutation.h"
#include "sim/virtual_line_faults.h"

namespace limb_ring::promises {
namespace {

using core::Mutation;
using namespace std::chrono_literals;

struct Case {
  const char* name;
  Mutation mutation;
  Promise promise;
};
std::ostream& operator<<(std::ostream& out, const Case& one) { return out << one.name; }

sim::VirtualRingOptions options() {
  sim::VirtualRingOptions options;
  options.nodes = 5;
  options.keep_logs = false;
  options.adjust = [](core::Settings& settings) { sim::set_short_times(settings, false, false); };
  return options;
}

/// Packets of all kinds over lines that lose one now and then; one of the nodes dies.
class Traffic {
 public:
  Traffic() : ring_(options()) {
    ring_.join();
    for (const wire::NodeId id : ring_.order())
      ring_.tap(id, [this](const wire::Slice& slice, core::Time, wire::SliceWriter& arriving) {
        if (loses_ && sim::is_traffic(slice) && random_() % 40 == 0) return;
        arriving.put(slice.kind, slice.bytes);
      });
  }

  void run() {
    for (int turn = 0; turn < 1500; ++turn) {
      loses_ = turn > 300;  // until then the judge has seen for long enough
      if (turn == 1000) ring_.kill(wire::NodeId{4});
      send();
      ring_.run_for(20us);
    }
  }
  sim::VirtualRing& ring() { return ring_; }

 private:
  void send() {
    const wire::NodeId from{static_cast<std::uint8_t>(random_() % 4)};
    wire::NodeId to{static_cast<std::uint8_t>(random_() % 5)};
    if (random_() % 4 == 0) to = wire::kBroadcast;
    const std::uint32_t number = ++number_;
    ring_.send(from, to, {std::uint8_t(number), std::uint8_t(number >> 8)}, random_() % 4);
    if (random_() % 4 == 0) ring_.interrupt(from, to, static_cast<std::uint8_t>(random_() % 8));
  }

  std::mt19937 random_{7};
  std::uint32_t number_ = 0;
  bool loses_ = false;
  sim::VirtualRing ring_;
};

/// What is found while it runs.
std::vector<Breach> judged_live() {
  Traffic traffic;
  JudgedRing judged(traffic.ring());
  traffic.run();
  judged.finish();
  return judged.breaches();
}

/// What is found in what the nodes' flight recorders have left of it.
std::vector<Breach> judged_from_recordings() {
  Traffic traffic;
  recorder::RecordedLives recorded(traffic.ring());
  traffic.run();
  const auto folder = std::filesystem::temp_directory_path() / ("judged" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  unsigned id = 0;
  for (const auto& saved : recorded.end_all()) {
    std::ofstream out(recorder::recording_of(folder.string(), id++), std::ios::binary);
    out.write(reinterpret_cast<const char*>(saved.data()), static_cast<std::streamsize>(saved.size()));
  }
  recorder::ReplayedRing ring(folder.string());
  recorder::ReplayedPromises promises(ring, JudgedRing::times(), 50us, 50us);
  while (recorder::ReplayedLife* life = ring.step(std::chrono::hours(1))) promises.has_done(*life);
  promises.finish();
  std::filesystem::remove_all(folder);
  for (const auto& life : ring.lives()) EXPECT_FALSE(life->replay().difference());
  EXPECT_GT(promises.counts().judged, 400u);
  return promises.breaches();
}

std::vector<Promise> promises_of(const std::vector<Breach>& breaches) {
  std::vector<Promise> promises;
  for (const Breach& breach : breaches) promises.push_back(breach.promise);
  return promises;
}
std::string words_of(const std::vector<Breach>& breaches) {
  std::string words;
  for (const Breach& breach : breaches) words += std::string(to_string(breach.promise)) + ": " + breach.what + '\n';
  return words;
}

struct JudgedMutations : testing::TestWithParam<Case> {
  ~JudgedMutations() override { core::mutation = Mutation::none; }
};

TEST(JudgedTraffic, ofASoundCoreBreaksNothing) {
  EXPECT_EQ(words_of(judged_live()), "");
  EXPECT_EQ(words_of(judged_from_recordings()), "");
}

TEST_P(JudgedMutations, areNamedWhileTheRingRuns) {
  core::mutation = GetParam().mutation;
  const auto breaches = judged_live();
  EXPECT_THAT(promises_of(breaches), testing::Contains(GetParam().promise)) << words_of(breaches);
}

TEST_P(JudgedMutations, areNamedFromRecordings) {
  core::mutation = GetParam().mutation;
  const auto breaches = judged_from_recordings();
  EXPECT_THAT(promises_of(breaches), testing::Contains(GetParam().promise)) << words_of(breaches);
}

// Those that show at CPUs, and not on the lines alone. What is called delivered to a dead node is not judged: nobody
// sees that one.
INSTANTIATE_TEST_SUITE_P(Each, JudgedMutations,
                         testing::Values(Case{"ResultTwice", Mutation::result_twice, Promise::one_result},
                                         Case{"ForgetsDuplicates", Mutation::forgets_duplicates, Promise::exactly_once},
                                         Case{"MissesBroadcasts", Mutation::misses_broadcasts, Promise::true_result}),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace limb_ring::promises
