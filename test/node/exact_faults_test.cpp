// CPUs that crash, hang, loop and are reset: at exact instants of the ring's clock, and each time the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "config/load_ring.h"
#include "node/virtual_ring_host.h"
#include "sim/planned_ring.h"
#include "support/own_folder.h"

namespace limb_ring::virtual_host {
namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

/// "crashes 500" as members of a YAML list.
std::string commas(std::string words) { return words.replace(words.find(' '), 1, ", "); }

/// A fault at an instant of the ring's.
struct Planned {
  milliseconds at;
  std::string words;
};

struct Seen {
  std::uint64_t hash = 0;
  std::string not_repeatable;
  std::vector<std::int64_t> beats;  ///< of node knee's CPU, us
  std::vector<std::string> problems;

  /// The first one from then on; 0: none.
  microseconds next_beat(milliseconds from) const {
    for (const std::int64_t beat : beats)
      if (microseconds(beat) >= from) return microseconds(beat);
    return 0us;
  }
  /// None after the first instant, up to the second.
  bool silent(milliseconds after, milliseconds until) const {
    return std::none_of(beats.begin(), beats.end(),
                        [=](std::int64_t beat) { return microseconds(beat) > after && microseconds(beat) < until; });
  }
};

/// Keeps all cores busy while it lives.
class Busy {
 public:
  Busy() {
    for (unsigned i = 0; i < 2 * std::thread::hardware_concurrency(); ++i)
      threads_.emplace_back([this] {
        while (!over_) {
        }
      });
  }
  ~Busy() {
    over_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  std::atomic<bool> over_{false};
  std::vector<std::thread> threads_;
};

/// Nodes body, hip and knee: hip has a CPU that goes on, knee one that does as it is told.
struct ExactFaults : test::OwnFolder {
  ExactFaults() { spdlog::set_level(spdlog::level::err); }

  Seen run(const std::string& cpu, const std::vector<Planned>& plan, milliseconds lasts = 1000ms) const {
    const std::string beats = folder + "/beats";
    std::remove(beats.c_str());
    const std::string program = std::string("[") + PLANNED_CPU + ", ";
    const auto given = config::load_ring(write("ring.yaml", R"(
ring: exact
timeouts: {beacon: 20ms}
virtual: {stall: 1s}
supervisor: {policy: auto, grace: 50ms, backoff: 20ms}
nodes:
  - {id: 0, name: body}
  - {id: 1, name: hip, cpu: {command: )" + program + folder + R"(/hip, goes_on, 999999], alive_period: 50ms}}
  - {id: 2, name: knee, cpu: {command: )" + program + beats + ", " +
                                                                commas(cpu) + "], alive_period: 50ms}}\n"));
    const config::RingConfig ring = sim::with_assumed_lines(given, sim::kUsualRate, sim::kUsualRelayDelay);
    Seen seen;
    boost::asio::io_context io(1);
    VirtualRingHost host(io, ring);
    const fault::RingNodes nodes = fault::nodes_by_id(ring);
    for (const Planned& planned : plan)
      host.at(core::Time{} + planned.at, [&host, &seen, fault = fault::from_words(planned.words, nodes)] {
        host.begin(fault, [&seen](const std::string& problem) {
          if (!problem.empty()) seen.problems.push_back(problem);
        });
      });
    host.start();
    Pace pace(INFINITY, std::chrono::steady_clock::now());
    host.run(pace, core::Time{} + lasts);
    seen.hash = host.trace_hash();
    seen.not_repeatable = host.not_repeatable();
    std::ifstream file(beats);
    for (std::int64_t us = 0; file >> us;) seen.beats.push_back(us);
    return seen;
  }
  /// The same, several times, at last beside busy threads.
  Seen same_each_time(const std::string& cpu, const std::vector<Planned>& plan, milliseconds lasts = 1000ms) const {
    const Seen first = run(cpu, plan, lasts);
    for (int i = 0; i < 2; ++i) expect_same(run(cpu, plan, lasts), first);
    const Busy busy;
    for (int i = 0; i < 2; ++i) expect_same(run(cpu, plan, lasts), first);
    return first;
  }
  static void expect_same(const Seen& again, const Seen& first) {
    EXPECT_EQ(again.hash, first.hash);
    EXPECT_EQ(again.beats, first.beats);
    EXPECT_EQ(again.not_repeatable, first.not_repeatable);
    EXPECT_THAT(again.problems, IsEmpty());
  }
};

// It boots for 20 ms, and sends each 10 ms from then on.

TEST_F(ExactFaults, ACpuThatHangsIsSilentAtOnceAndGoesOnInTheInstantThatEndsIt) {
  const Seen seen = same_each_time("goes_on 999999", {{501ms, "hang knee for=30ms"}});
  EXPECT_EQ(seen.not_repeatable, "");
  EXPECT_TRUE(seen.silent(500ms, 531ms));
  EXPECT_EQ(seen.next_beat(501ms), 531ms) << "its time is the ring's";
  EXPECT_THAT(seen.beats, Contains(541'000));
}

TEST_F(ExactFaults, ACpuThatHangsIsFoundByTheSupervisorAndReset) {
  const Seen seen = same_each_time("goes_on 999999", {{500ms, "hang knee"}});
  EXPECT_EQ(seen.not_repeatable, "");
  const microseconds next = seen.next_beat(501ms);
  EXPECT_GT(next, 650ms) << "three alive periods";
  EXPECT_LT(next, 1s);
}

TEST_F(ExactFaults, AHangMayBeEndedByAReset) {
  const Seen seen = same_each_time("goes_on 999999", {{500ms, "hang knee"}, {530ms, "reset knee"}});
  EXPECT_EQ(seen.not_repeatable, "");
  EXPECT_EQ(seen.next_beat(501ms), 550ms) << "reset, and 20 ms to boot";
}

TEST_F(ExactFaults, ACrashIsOfItsInstant) {
  const Seen seen = same_each_time("goes_on 999999", {{503ms, "crash knee"}});
  EXPECT_EQ(seen.not_repeatable, "");
  EXPECT_EQ(seen.next_beat(503ms), 623ms) << "started again after 100 ms, and 20 ms to boot";
}

TEST_F(ExactFaults, AHungCpuMayCrash) {
  const Seen seen = same_each_time("goes_on 999999", {{503ms, "hang knee"}, {520ms, "crash knee"}});
  EXPECT_EQ(seen.not_repeatable, "");
  EXPECT_EQ(seen.next_beat(503ms), 640ms);
}

TEST_F(ExactFaults, ACpuThatCrashesInTheMiddleOfItsTurnDoesSoInThatInstantEachTimeItBoots) {
  const Seen seen = same_each_time("crashes 500", {});
  EXPECT_EQ(seen.not_repeatable, "");
  EXPECT_EQ(seen.next_beat(501ms), 620ms);
  EXPECT_GT(seen.next_beat(621ms), 740ms) << "twice in a row: it waits longer";
}

TEST_F(ExactFaults, ACpuThatEndsWhileItBootsIsSeenToEndWhenThatIsOver) {
  const Seen seen = same_each_time("does_not_boot 0", {});
  EXPECT_EQ(seen.not_repeatable, "");
  EXPECT_THAT(seen.beats, IsEmpty());
}

TEST_F(ExactFaults, AResetWhileItBootsBeginsItsBootAnew) {
  const Seen seen = same_each_time("goes_on 999999", {{500ms, "reset knee"}, {507ms, "reset knee"}});
  EXPECT_EQ(seen.not_repeatable, "");
  EXPECT_EQ(seen.next_beat(501ms), 527ms);
}

TEST_F(ExactFaults, AHangWhileItBootsPutsThatOff) {
  const Seen seen = same_each_time("goes_on 999999", {{500ms, "reset knee"}, {510ms, "hang knee for=40ms"}});
  EXPECT_EQ(seen.not_repeatable, "");
  EXPECT_EQ(seen.next_beat(501ms), 550ms);
}

TEST_F(ExactFaults, ACpuInAnEndlessLoopIsResetAtAnInstantToo) {
  const Seen seen = same_each_time("loops 500", {{520ms, "reset knee"}}, 540ms);
  EXPECT_EQ(seen.not_repeatable, "a CPU was stuck");
  EXPECT_EQ(seen.next_beat(501ms), 540ms);
}

TEST_F(ExactFaults, NodesAreKilledFrozenAndCycledAtTheirInstants) {
  const Seen killed = same_each_time("goes_on 999999", {{500ms, "kill knee"}, {600ms, "start knee"}});
  EXPECT_EQ(killed.not_repeatable, "");
  EXPECT_EQ(killed.next_beat(501ms), 620ms);
  const Seen frozen = same_each_time("goes_on 999999", {{503ms, "freeze knee for=40ms"}});
  EXPECT_EQ(frozen.not_repeatable, "");
  EXPECT_EQ(frozen.next_beat(503ms), 543ms);
  const Seen cycled = same_each_time("goes_on 999999", {{503ms, "power_cycle hip knee"}, {510ms, "power_cycle all"}});
  EXPECT_EQ(cycled.not_repeatable, "");
  EXPECT_EQ(cycled.next_beat(503ms), 530ms);
}

TEST_F(ExactFaults, WhatIsOfADeadOrFrozenNodeIsRefused) {
  const Seen seen = run("goes_on 999999", {{500ms, "kill knee"},
                                           {510ms, "hang knee"},
                                           {510ms, "cut knee -> body"},
                                           {520ms, "freeze hip"},
                                           {530ms, "reset hip"}});
  EXPECT_THAT(seen.problems, ElementsAre("node knee is dead", "node knee is dead", "node hip is frozen"));
}

}  // namespace
}  // namespace limb_ring::virtual_host
