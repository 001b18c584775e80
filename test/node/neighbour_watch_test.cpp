#include "node/neighbour_watch.h"

#include <gmock/gmock.h>

#include "config/load_ring.h"

namespace limb_ring::runtime {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// At hip, behind knee, which is behind body.
class NeighbourWatchTest : public ::testing::Test {
 protected:
  NeighbourWatch::Look look() { return {now, counters, peers, core::NodeState::up, 3, 1}; }
  std::vector<std::string> looks(unsigned count = 1) {
    std::vector<std::string> log;
    for (unsigned i = 0; i < count; ++i) {
      now += 1s;
      hear_all();
      for (const auto& line : watch.look(state ? changed() : look())) log.push_back(line);
    }
    return log;
  }
  NeighbourWatch::Look changed() {
    NeighbourWatch::Look one = look();
    state(one);
    return one;
  }
  void hear_all() {
    hear(1, knee_hop, 0);
    if (body_comes) hear(0, body_hop, 2);
  }
  void hear(std::uint8_t node, std::uint8_t hop, std::uint8_t input_from) {
    wire::Beacon beacon;
    beacon.input = wire::LinkState::up;
    beacon.input_from = wire::NodeId{input_from};
    peers.heard_beacon(wire::NodeId{node}, hop, beacon, now);
  }
  std::vector<std::string> texts() const {
    std::vector<std::string> all;
    for (const Warning& warning : watch.warnings()) all.push_back(warning.text);
    return all;
  }

  config::RingConfig ring =
      config::parse_ring("ring: r\nnodes: [{id: 0, name: body}, {id: 1, name: knee}, {id: 2, name: hip}]\n", "r.yaml");
  core::Time now{100s};
  core::Counters counters;
  core::Peers peers;
  std::uint8_t knee_hop = 0, body_hop = 1;
  bool body_comes = true;
  std::function<void(NeighbourWatch::Look&)> state;
  NeighbourWatch watch{ring, 2};
};

TEST_F(NeighbourWatchTest, SaysNothingOfARingThatIsWell) {
  EXPECT_THAT(looks(20), IsEmpty());
  EXPECT_THAT(texts(), IsEmpty());
}

TEST_F(NeighbourWatchTest, NamesANeighbourThatDoesNotCountHop) {
  body_hop = 0;
  EXPECT_THAT(looks(2), IsEmpty()) << "a ring that changes may look so for a moment";
  EXPECT_THAT(looks(), ElementsAre("knee: HOP of packets of body is 0, 1 expected (protocol.md section 2.2)"));
  EXPECT_THAT(looks(50), IsEmpty()) << "logged once a minute";
  EXPECT_EQ(texts().size(), 1u);
  body_hop = 1;
  looks();
  EXPECT_THAT(texts(), IsEmpty());
}

TEST_F(NeighbourWatchTest, NamesANeighbourWhoseOwnPacketsDoNotBeginWithHop0) {
  knee_hop = 3;
  EXPECT_THAT(looks(3), ElementsAre("knee: HOP of its own packets is 3, 0 expected (protocol.md section 2.2)"));
}

TEST_F(NeighbourWatchTest, NamesANeighbourThatPassesNothingOn) {
  looks();
  body_comes = false;
  EXPECT_THAT(looks(10), ElementsAre("knee passes nothing on: it hears body, and only its own packets come "
                                     "(protocol.md section 2.2)"));
}

TEST_F(NeighbourWatchTest, NamesTheNeighbourAndTheSourceOfWhatIsNoPacket) {
  counters.malformed_packets = 12;
  counters.last_malformed = {0, 1};
  EXPECT_THAT(looks(),
              ElementsAre("12 packets in 10 s from knee with a wrong header or trailer, the last of source body "
                          "(protocol.md section 2.2)"));
  looks(9);
  EXPECT_EQ(texts().size(), 1u);
  looks();
  EXPECT_THAT(texts(), IsEmpty()) << "ten seconds later it is over";
}

TEST_F(NeighbourWatchTest, TellsOfEachRule) {
  ++counters.oversize_packets;
  counters.last_oversize = {77, 0};
  counters.stray_slices = 21;
  ++counters.control_malformed;
  counters.last_control = {1, 0};
  counters.duplicate_id_signs = 4;
  state = [](NeighbourWatch::Look& look) {
    look.no_slices = 1;
    look.other_session = 248;
    look.other_session_of = 1;
    look.line_losses = 25;
    look.last_loss = "input lost: silent";
  };
  EXPECT_THAT(looks(),
              ElementsAre(HasSubstr("1 packet in 10 s from knee of more than 524 bytes, the last of source 77"),
                          HasSubstr("21 slices in 10 s from knee that belong to no packet"),
                          HasSubstr("1 stream or datagram in 10 s from knee that held no slice"),
                          HasSubstr("1 packet in 10 s on channel 1, neither hello nor beacon, the last of source knee"),
                          HasSubstr("4 signs in 10 s that another node has the id of this one, 2"),
                          HasSubstr("248 datagrams in 10 s from knee of a session that this node does not have"),
                          HasSubstr("a line of this node was lost 25 times in 10 s, the last: input lost: silent")));
}

TEST_F(NeighbourWatchTest, OrdinaryFaultsAreNotBrokenRules) {
  counters.stray_slices = 20;
  counters.duplicate_id_signs = 3;
  state = [](NeighbourWatch::Look& look) { look.other_session = 20, look.line_losses = 4; };
  EXPECT_THAT(looks(), IsEmpty());
}

}  // namespace
}  // namespace limb_ring::runtime
