#include "study/traffic_run.h"

#include <algorithm>
#include <random>

#include "config/load_ring.h"
#include "sim/planned_ring.h"
#include "study/small_ring.h"

namespace limb_ring::study {
namespace {

using core::Outcome;

std::size_t count(const StreamRun& run, Outcome outcome) { return run.outcomes[static_cast<std::size_t>(outcome)]; }

std::vector<StreamRun> run(const config::RingConfig& ring, const std::vector<Stream>& streams, Duration duration,
                           std::uint64_t seed = 1) {
  TrafficOptions options;
  options.duration = duration;
  options.seed = seed;
  return run_traffic(ring, streams, options);
}

void expect_kept(const config::RingConfig& ring, const std::vector<Stream>& streams, Duration duration,
                 std::uint64_t seed) {
  const Plan made = plan(ring, streams);
  const std::vector<StreamRun> runs = run(ring, streams, duration, seed);
  for (std::size_t s = 0; s < streams.size(); ++s) {
    EXPECT_TRUE(kept(made.streams[s], runs[s]))
        << "seed " << seed << ", " << streams[s].name << ": confirmed " << microseconds(runs[s].confirmed.max())
        << " us, " << made.streams[s].why;
  }
}

// T = 0.8 us, d = 1 us; home after three hops, at c after two.
TEST(TrafficRun, APacketAloneTakesWhatTheFormulaSays) {
  const auto runs = run(small_ring(3), {stream_from(0, 2, {kHundred}, 1ms)}, 10ms);
  EXPECT_EQ(runs[0].asked, 10u);
  EXPECT_EQ(count(runs[0], Outcome::delivered), 10u);
  EXPECT_EQ(runs[0].confirmed.min(), ns(3800));
  EXPECT_EQ(runs[0].confirmed.max(), ns(3800));
  EXPECT_EQ(runs[0].delivered.min(), ns(2800));
  EXPECT_EQ(runs[0].delivered.max(), ns(2800));
}

// The lines into a, b, c have 1, 5, 2 us: home after 8, at c after 7.
TEST(TrafficRun, EveryLineHasItsOwnDelay) {
  config::RingConfig ring = small_ring(3);
  ring.nodes[1].link.delay = 5us;
  ring.nodes[2].link.delay = 2us;
  const auto runs = run(ring, {stream_from(0, 2, {kHundred}, 1ms)}, 5ms);
  EXPECT_EQ(runs[0].confirmed.max(), ns(8800));
  EXPECT_EQ(runs[0].delivered.max(), ns(7800));
}

// 0.096 us on the line, then 2 hops of 1 us.
TEST(TrafficRun, AnInterruptIsDeliveredWhenItsPinIsPulled) {
  const auto runs = run(small_ring(3), {interrupts_from(0, 2, 1, 1ms)}, 5ms);
  EXPECT_EQ(runs[0].asked, 5u);
  EXPECT_EQ(runs[0].delivered.max(), ns(2096));
  EXPECT_EQ(runs[0].confirmed.max(), ns(3096));
}

TEST(TrafficRun, ToAllIsDeliveredWithTheLastNodeAndToItselfWhenHome) {
  Stream own = stream_from(1, 1, {kHundred}, 1s);
  own.phase = Duration{0};
  const auto runs = run(small_ring(3), {stream_from(0, wire::kBroadcast, {kHundred}, 1ms), own}, 2ms);
  ASSERT_EQ(runs[1].asked, 1u);
  EXPECT_EQ(runs[0].delivered.min(), ns(2800));
  EXPECT_EQ(runs[1].delivered.values(), runs[1].confirmed.values());
}

// Three laps of 3.8 us, one after the other.
TEST(TrafficRun, AMessageOfSeveralPacketsEndsWithItsLast) {
  const auto runs = run(small_ring(3), {stream_from(0, 2, {kHundred, kHundred, kHundred}, 1ms)}, 3ms);
  EXPECT_EQ(runs[0].confirmed.max(), ns(3 * 3800));
  EXPECT_EQ(count(runs[0], Outcome::delivered), 3 * runs[0].asked);
}

TEST(TrafficRun, GivenPhasesAreKeptAndTheSeedChoosesTheRest) {
  Stream fixed = stream_from(0, 1, {kHundred}, 1ms), any = stream_from(1, 0, {188}, 10us);
  fixed.phase = Duration{900us};
  const auto first = run(small_ring(2), {fixed, any}, 2ms, 1), again = run(small_ring(2), {fixed, any}, 2ms, 1);
  const auto other = run(small_ring(2), {fixed, any}, 2ms, 2);
  EXPECT_EQ(first[0].asked, 2u);  // at 0.9 and 1.9 ms
  EXPECT_EQ(first[0].confirmed.values(), again[0].confirmed.values());
  EXPECT_EQ(first[1].confirmed.values(), again[1].confirmed.values());
  EXPECT_NE(first[0].confirmed.values(), other[0].confirmed.values());
}

TEST(TrafficRun, BeaconsAreTheNetworkControllersOwn) {
  config::RingConfig ring = small_ring(2);
  ring.timeouts.beacon = 10ms;
  const auto streams = streams_of(ring);
  const auto runs = run(ring, streams, 100ms);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_GE(runs[0].asked, 9u);
  EXPECT_LE(runs[0].asked, 11u);
  EXPECT_EQ(runs[0].delivered.count(), 0u);
  EXPECT_GE(runs[0].confirmed.min(), ns((26 + 12) * 8 + 2000));
}

TEST(TrafficRun, AnOverloadedNodeFallsBehindAndStillEnds) {
  config::RingConfig ring = small_ring(2);
  ring.timeouts.queue = 5ms;
  const auto runs = run(ring, {stream_from(0, 1, {kHundred}, 1us)}, 10ms);
  EXPECT_EQ(runs[0].asked, 10000u);
  EXPECT_LT(runs[0].confirmed.count(), 10000u);
}

TEST(TrafficRun, AFullSendQueueIsSeen) {
  config::RingConfig ring = small_ring(2);
  ring.limits.send_queue = 1;
  const std::vector<Stream> streams{stream_from(0, 1, {kHundred, kHundred, kHundred}, 1ms)};
  const auto runs = run(ring, streams, 5ms);
  EXPECT_EQ(count(runs[0], Outcome::rejected), 2 * runs[0].asked);
  EXPECT_EQ(runs[0].confirmed.count(), 0u);
  EXPECT_FALSE(kept(plan(ring, streams).streams[0], runs[0]));
}

TEST(Bounds, HoldOnTheHumanoid) {
  const config::RingConfig file = config::load_ring(std::string(SHIPPED_CONFIG) + "/humanoid16.yaml");
  const config::RingConfig ring = sim::with_assumed_lines(file, 1'000'000'000, 512ns);
  EXPECT_TRUE(plan(ring, streams_of(ring)).carried());
  for (std::uint64_t seed = 1; seed <= 3; ++seed) expect_kept(ring, streams_of(ring), 200ms, seed);
}

// The worst case of one node: when its packet passes the others, each has just begun one of its own.
TEST(Bounds, AreReachedWhenEveryNodeStartsJustBeforeThePacketArrives) {
  const config::RingConfig ring = small_ring(4);
  std::vector<Stream> streams;
  for (NodeId n{0}; n < 4; ++n) streams.push_back(stream_from(n, static_cast<NodeId>((n + 3) % 4), {kHundred}, 1ms));
  // Node 3's packet reaches node 0 1 us after its start, just before node 0 asks: node 0 waits 0.8 us for it.
  // It starts at 1.8 us and reaches node 1 at 2.8 us, where one has started then; the same 1.8 us later at
  // node 2, and again at node 3, whose first is home by then.
  streams[3].phase = Duration{0};
  streams[0].phase = Duration{1us} + Duration{1};
  streams[1].phase = Duration{2800ns};
  streams[2].phase = Duration{4600ns};
  streams.push_back(stream_from(3, 2, {kHundred}, 1ms));
  streams.back().phase = Duration{6400ns};
  const Plan made = plan(ring, streams);
  const auto runs = run(ring, streams, 1ms);
  EXPECT_EQ(made.streams[0].confirmed, ns(800 + 4 * 1800));
  EXPECT_EQ(runs[0].confirmed.max() + Duration{1}, ns(800 + 4 * 1800));
}

// a's 512 bytes begin 50 ns before the packets of the nine others come in, 130 ns apart (each takes 104 ns), the
// nearest first. All nine have to wait, and find room.
TEST(Bounds, HoldForManySmallPacketsBehindALargeOne) {
  config::RingConfig ring = small_ring(10);
  std::vector<Stream> streams{stream_from(0, 1, {512}, 1s)};
  streams[0].phase = Duration{19'950ns};
  for (NodeId n{1}; n < 10; ++n) {
    streams.push_back(stream_from(n, 0, {1}, 1s));
    streams.back().phase = Duration{20us} + Duration{130ns} * (9 - n) - Duration{1us} * (10 - n);
  }
  ring.limits.insertion_buffer = 2;
  expect_kept(ring, streams, 1ms, 1);
}

TEST(Bounds, HoldWhenEverybodyStartsAtOnce) {
  config::RingConfig ring = small_ring(3);
  ring.timeouts.beacon = 10ms;
  std::vector<Stream> streams = streams_of(ring);
  for (NodeId n{0}; n < 3; ++n)
    for (std::uint8_t priority = 0; priority < 4; ++priority)
      streams.push_back(stream_from(n, static_cast<NodeId>((n + 1 + priority % 2) % 3),
                                    std::vector<unsigned>(1 + priority, 512), Duration{400us} * (1 + priority),
                                    priority));
  for (NodeId n{0}; n < 3; ++n) streams.push_back(interrupts_from(n, wire::kBroadcast, 1, 10us));
  for (Stream& stream : streams) stream.phase = Duration{0};
  expect_kept(ring, streams, 20ms, 1);
}

// ---- rings at random ------------------------------------------------------------------------

class RandomRing {
 public:
  explicit RandomRing(std::uint64_t seed) : random_(seed) {
    ring = small_ring(2 + below(5));
    ring.timeouts.beacon = std::chrono::milliseconds(10 + below(20));
    ring.limits.insertion_buffer = 2;
    ring.limits.send_queue = ring.limits.receive_buffers = 1000;
    const bool lines_differ = below(2) == 1;
    for (config::NodeConfig& node : ring.nodes) {
      node.pins.fill({config::PinConfig::Action::notify, 0, {}});
      if (!lines_differ) continue;
      node.link.rate = std::uint64_t{100'000'000} << below(5);
      node.link.delay = std::chrono::nanoseconds(below(2000));
    }
    streams = streams_of(ring);
    for (std::uint64_t left = 1 + below(8); left > 0; --left) streams.push_back(data());
    for (std::uint64_t left = below(4); left > 0; --left) streams.push_back(interrupts());
  }

  config::RingConfig ring;
  std::vector<Stream> streams;

 private:
  std::uint64_t below(std::uint64_t limit) { return random_() % limit; }
  NodeId node() { return static_cast<NodeId>(below(ring.nodes.size())); }
  NodeId target() { return below(4) == 0 ? wire::kBroadcast : node(); }
  Duration up_to(std::uint64_t nanoseconds) { return ns(static_cast<std::int64_t>(below(nanoseconds))); }

  Stream data() {
    std::vector<unsigned> packets(below(3) == 0 ? 1 + below(6) : 1);
    for (unsigned& packet : packets) packet = below(3) == 0 ? 512 : static_cast<unsigned>(1 + below(512));
    const Duration period = Duration{20us} * static_cast<int>(packets.size()) + up_to(400'000);
    Stream stream = stream_from(node(), target(), packets, period, static_cast<std::uint8_t>(below(4)));
    if (below(3) == 0) stream.jitter = up_to(100'000);
    if (below(2) == 0) stream.phase = up_to(6000);
    return stream;
  }

  Stream interrupts() {
    return interrupts_from(node(), target(), static_cast<std::uint8_t>(below(8)), Duration{20us} + up_to(200'000));
  }

  std::mt19937_64 random_;
};

TEST(Bounds, HoldOnRandomRings) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    RandomRing random(seed);
    for (const NodePlan& node : plan(random.ring, random.streams).nodes)
      random.ring.limits.insertion_buffer =
          std::max<unsigned>(*random.ring.limits.insertion_buffer, 2 + static_cast<unsigned>(node.waiting / 524));
    expect_kept(random.ring, random.streams, 10ms, seed);
  }
}

}  // namespace
}  // namespace limb_ring::study
