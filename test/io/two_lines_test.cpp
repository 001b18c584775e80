// An input that nodes of its own host reach in one way and those of other hosts in another.
#include "io/link_rig.h"

namespace limb_ring::link {
namespace {

/// Nodes 0 and 2 are on one host, node 1 and 3 on another: 0 -> 1 -> 2 -> 3 -> 0, all lines UDP, and every bypass of
/// one node local.
struct TwoLines : testing::TestWithParam<Endpoint::Transport> {
  LinkRig udp{4, Endpoint::Transport::udp};
  LinkRig local{4, GetParam()};

  static bool same_host(std::size_t a, std::size_t b) { return a % 2 == b % 2; }
  RigNode& node(std::size_t i) { return udp.node(i); }

  void start_input(std::size_t i) {
    InputSettings in = local.input_settings(i);
    in.from_hosts = udp.endpoint(i);
    node(i).input = std::make_unique<Input>(node(i).io, in, node(i).heard);
  }
  void start_output(std::size_t i) {
    OutputSettings out = udp.output_settings(i);
    for (Candidate& candidate : out.candidates)
      if (same_host(i, candidate.id)) candidate.endpoint = local.endpoint(candidate.id);
    node(i).output = std::make_unique<Output>(node(i).io, out, node(i).said);
  }
  void start(std::size_t i) {
    start_input(i);
    start_output(i);
  }
  void SetUp() override {
    for (std::size_t i = 0; i < 4; ++i) start(i);
    ASSERT_TRUE(udp.until([&] { return udp.whole(); }));
  }
};

INSTANTIATE_TEST_SUITE_P(On, TwoLines, testing::Values(Endpoint::Transport::unix_stream, Endpoint::Transport::shm),
                         transport_name);

TEST_P(TwoLines, BypassMovesTheInputToItsOtherLineAndBack) {
  udp.end(1);
  ASSERT_TRUE(udp.until([&] { return udp.linked(0, 2); }));
  EXPECT_GT(node(2).input->counters().datagrams, 0u) << "before the bypass";
  start_output(1);  // its input comes later, so that node 0 does not leave by itself
  ASSERT_TRUE(udp.until([&] { return node(2).input->counters().replaced == 1; }))
      << "node 0 gave way to node 1, which came in by the other line";
  start_input(1);
  ASSERT_TRUE(udp.until([&] { return udp.whole(); }));
}

TEST_P(TwoLines, NodeFartherAwayOnTheOtherLineIsRefusedWhileTheNearerOneIsThere) {
  Output unknown(
      node(0).io,
      [&] {
        OutputSettings out = local.output_settings(0);
        out.candidates = {{2, local.endpoint(2)}, {0, local.endpoint(0)}};
        return out;
      }(),
      node(0).said);
  ASSERT_TRUE(udp.until([&] { return unknown.counters().refused > 0; }));
  EXPECT_TRUE(udp.whole());
}

TEST_P(TwoLines, SlicesComeByWhicheverLineItIs) {
  udp.end(1);
  ASSERT_TRUE(udp.until([&] { return udp.linked(0, 2); }));
  wire::SliceWriter writer;
  put_whole(writer, 30, 7);
  node(0).output->write(writer.view());
  ASSERT_TRUE(udp.until([&] { return node(2).heard.slices.size() == 1; }));
  start(1);
  ASSERT_TRUE(udp.until([&] { return udp.whole(); }));
  node(1).output->write(writer.view());
  ASSERT_TRUE(udp.until([&] { return node(2).heard.slices.size() == 2; }));
}

}  // namespace
}  // namespace limb_ring::link
