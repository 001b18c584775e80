// The journal of a node gets every call that changes the node, before it happens.
#include "core/journal.h"

#include "core/network_controller.h"
#include "core/ring_fixture.h"
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;

/// What went in, by its place in Input, and which packets were said to pass only.
struct InputsSeen final : Journal {
  std::vector<std::size_t> seen;
  std::vector<bool> only_pass;
  void goes_in(const Input& input, Time) override {
    seen.push_back(input.index());
    if (const auto* call = std::get_if<input::Receive>(&input)) only_pass.push_back(call->only_passes);
  }
  void goes_out(Line, wire::ByteView) override {}
  void taken(const Event&, Time) override {}
  void taken(const ReceivedPacket&, Time) override {}
};

/// Node 1 of a ring of 4, with a journal.
struct JournalOfNode : testing::Test {
  JournalOfNode() { node.set_journal(&journal); }
  /// Whether the node says that it only passes.
  bool only_passes(const Bytes& bytes, wire::SliceKind kind = wire::SliceKind::whole) {
    node.receive(Line::first, {kind, {bytes.data(), bytes.size()}}, Time{});
    return journal.only_pass.back();
  }
  NetworkController node{SoloNode::settings(Duration{0}, [](Settings&) {}), Time{}};
  InputsSeen journal;
};

TEST_F(JournalOfNode, IsToldOfEveryCall) {
  const Bytes data = pattern(4);
  node.apply(input::InputUp{Line::first, 0_id}, Time{});
  node.apply(input::OutputUp{Line::first, 0_id}, Time{});
  node.set_output_ready(Line::first, false);
  node.receive(Line::first, {wire::SliceKind::idle, {}}, Time{});
  node.apply(input::Send{send_of(1, 1, 0_id, data)}, Time{});
  node.apply(input::Interrupt{{1, 2, 0_id, wire::Factor{1}}}, Time{});
  node.apply(input::Pull{1, 3, 0}, Time{});
  node.apply(input::Cancel{1}, Time{});
  node.apply(input::CpuReset{1}, Time{});
  node.apply(input::Cpu{{}}, Time{});
  node.set_cpu_present(true);
  node.apply(input::Timeout{}, Time{});
  node.apply(input::Run{}, Time{});
  node.apply(input::InputGap{Line::first}, Time{});
  node.apply(input::InputLost{Line::first}, Time{});
  node.apply(input::OutputLost{Line::first}, Time{});
  const auto of = [](const Input& input) { return input.index(); };
  EXPECT_THAT(journal.seen,
              ElementsAre(of(input::InputUp{}), of(input::OutputUp{}), of(input::OutputReady{}), of(input::Receive{}),
                          of(input::Send{}), of(input::Interrupt{}), of(input::Pull{}), of(input::Cancel{}),
                          of(input::CpuReset{}), of(input::Cpu{}), of(input::CpuPresent{}), of(input::Timeout{}),
                          of(input::Run{}), of(input::InputGap{}), of(input::InputLost{}), of(input::OutputLost{})));
}

TEST_F(JournalOfNode, IsToldWhichPacketsOnlyPass) {
  const Bytes data = pattern(40);
  const auto packet = [&](std::uint8_t from, std::uint8_t to) { return Foreign{from, to}.with(data); };
  EXPECT_TRUE(only_passes(packet(0, 2)));
  EXPECT_TRUE(only_passes(packet(1, 2))) << "its own, come home";
  EXPECT_TRUE(only_passes(packet(1, wire::kBroadcast))) << "its own, come home";
  EXPECT_FALSE(only_passes(packet(0, 1)));
  EXPECT_FALSE(only_passes(packet(1, 1)));
  EXPECT_FALSE(only_passes(packet(0, wire::kBroadcast)));
  EXPECT_FALSE(only_passes(Foreign{0, 2}.with_pri(kControlPri).with(data)));
  Bytes damaged = packet(0, 2);
  damaged[20] ^= 1;
  EXPECT_FALSE(only_passes(damaged));
  EXPECT_FALSE(only_passes(head_of(packet(0, 2)), wire::SliceKind::start));
}

}  // namespace
}  // namespace limb_ring::core
