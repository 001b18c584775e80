#include "config/ring_text.h"

namespace limb_ring::config {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::Eq;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// What is added to two_nodes() begins in line 6.
std::string with_traffic(const std::string& entry) { return two_nodes("traffic:\n  - " + entry + "\n"); }

TEST(Traffic, IsReadWithAllItsEntries) {
  const RingConfig ring = parse_ring(with_traffic("{name: camera, from: knee, to: 0, size: 61440, rate: 29.97, "
                                                  "priority: 2, jitter: 250us, phase: 3ms}"),
                                     "ring.yaml");
  ASSERT_EQ(ring.traffic.size(), 1u);
  const TrafficConfig& camera = ring.traffic[0];
  EXPECT_EQ(camera.name, "camera");
  EXPECT_EQ(camera.from, 1);
  EXPECT_EQ(camera.to, 0);
  EXPECT_FALSE(camera.broadcast);
  EXPECT_EQ(camera.size, 61440u);
  EXPECT_FALSE(camera.interrupt);
  EXPECT_EQ(camera.rate, 29.97);
  EXPECT_EQ(camera.priority, 2);
  EXPECT_EQ(camera.jitter, 250us);
  EXPECT_EQ(camera.phase, 3ms);
}

TEST(Traffic, HasTheLowestPriorityNoJitterAndAPhaseByTheSeedUnlessItSaysOtherwise) {
  const RingConfig ring =
      parse_ring(with_traffic("{name: camera, from: knee, to: body, size: 1, rate: 1}"), "ring.yaml");
  EXPECT_EQ(ring.traffic[0].priority, 3);
  EXPECT_EQ(ring.traffic[0].jitter, 0s);
  EXPECT_FALSE(ring.traffic[0].phase);
}

TEST(Traffic, MayBeAnInterruptToAll) {
  const RingConfig ring =
      parse_ring(with_traffic("{name: stop, from: body, to: all, interrupt: 1, rate: 0.1}"), "ring.yaml");
  EXPECT_TRUE(ring.traffic[0].broadcast);
  EXPECT_EQ(ring.traffic[0].interrupt, 1);
}

TEST(Traffic, IsAMessageOrAnInterrupt) {
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: 1, rate: 1}")),
              Eq("ring.yaml:7:5: entry 'traffic[0]': neither size nor interrupt is given; allowed: one of them: a "
                 "message or an interrupt"));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: 1, rate: 1, size: 8, interrupt: 1}")),
              HasSubstr("'traffic[0]': size and interrupt are both given"));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: 1, rate: 1, interrupt: 1, priority: 0}")),
              HasSubstr("'traffic[0].priority': an interrupt has no priority"));
}

TEST(Traffic, MustBeNamedAddressedAndRated) {
  EXPECT_THAT(refusal_of(with_traffic("{from: 0, to: 1, size: 8, rate: 1}")), HasSubstr("'name' is missing"));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, to: 1, size: 8, rate: 1}")), HasSubstr("'from' is missing"));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, size: 8, rate: 1}")), HasSubstr("'to' is missing"));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: 1, size: 8}")), HasSubstr("'rate' is missing"));
}

TEST(Traffic, GoesBetweenNodesOfThisRing) {
  EXPECT_THAT(
      refusal_of(with_traffic("{name: a, from: 0, to: kne, size: 8, rate: 1}")),
      AllOf(StartsWith("ring.yaml:7:28: entry 'traffic[0].to': 'kne' is not a node of this ring, did you mean 'knee'?"),
            HasSubstr("(body, knee), or all")));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: all, to: 1, size: 8, rate: 1}")),
              HasSubstr("'traffic[0].from': 'all' is not a node of this ring"));
}

TEST(Traffic, StaysWithinItsRanges) {
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: 1, size: 0, rate: 1}")),
              HasSubstr("'0' is out of range; allowed: a whole number, 1 to 32243220"));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: 1, size: 8, rate: 0}")),
              HasSubstr("'0' is out of range; allowed: a number, 0.001 to 100000 Hz"));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: 1, size: 8, rate: 1, priority: 4}")),
              HasSubstr("'traffic[0].priority': '4' is out of range"));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: 1, interrupt: 8, rate: 1}")),
              HasSubstr("'traffic[0].interrupt': '8' is out of range"));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: 1, size: 8, rate: 1, phase: 5}")),
              HasSubstr("'traffic[0].phase': '5' has no unit"));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: 1, size: 8, rate: 1, jitter: 11s}")),
              HasSubstr("'traffic[0].jitter': '11s' is out of range"));
}

// By default pins 0 to 2 are wired, the rest to nothing.
TEST(Traffic, PullsPinsThatAreWired) {
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: knee, interrupt: 3, rate: 1}")),
              Eq("ring.yaml:7:45: entry 'traffic[0].interrupt': pin 3 of node 'knee' is wired to nothing; allowed: a "
                 "factor that is wired at every destination"));
  EXPECT_THAT(refusal_of(with_traffic("{name: a, from: 0, to: all, interrupt: 3, rate: 1}")),
              HasSubstr("pin 3 of node 'knee' is wired to nothing"));
}

TEST(Traffic, HasEachNameOnce) {
  const std::string entry = "{name: a, from: 0, to: 1, size: 8, rate: 1}";
  EXPECT_THAT(refusal_of(with_traffic(entry + "\n  - " + entry)),
              StartsWith("ring.yaml:8:5: entry 'traffic[1]': 'a' is the name of another one"));
}

TEST(Traffic, ATopicIsPlannedBySizeAndRateTogether) {
  const auto topic = [](const std::string& more) {
    return "ring: r\nnodes: [{id: 0, cpu: attached}, {id: 1, cpu: attached}]\n"
           "bridge: {topics: [{input: a, from: 0, to: 1" +
           more + "}]}\n";
  };
  const RingConfig ring = parse_ring(topic(", size: 1000, rate: 2.5"), "ring.yaml");
  EXPECT_EQ(ring.bridge.topics[0].size, 1000u);
  EXPECT_EQ(ring.bridge.topics[0].rate, 2.5);
  EXPECT_EQ(parse_ring(topic(""), "ring.yaml").bridge.topics[0].size, 0u);
  EXPECT_THAT(refusal_of(topic(", size: 1000")),
              HasSubstr("the topic has a size and no rate; allowed: size and rate, or neither of them"));
  EXPECT_THAT(refusal_of(topic(", rate: 5")), HasSubstr("the topic has a rate and no size"));
}

}  // namespace
}  // namespace limb_ring::config
