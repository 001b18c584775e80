// Whoever keeps a journal of a node is told of every call that changes it, before it happens.
#include "core/journal.h"

#include "core/network_controller.h"
#include "core/ring_fixture.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;

/// What went in, by its place in Input.
struct InputsSeen final : Journal {
  std::vector<std::size_t> seen;
  void goes_in(const Input& input, Time) override { seen.push_back(input.index()); }
  void goes_out(Line, wire::ByteView) override {}
  void taken(const Event&, Time) override {}
  void taken(const ReceivedPacket&, Time) override {}
};

TEST(Journal, IsToldOfEveryCall) {
  Settings settings;
  settings.id = 1_id;
  settings.order = {0_id, 1_id};
  NetworkController node{settings, Time{}};
  InputsSeen journal;
  node.set_journal(&journal);
  const Bytes data = pattern(4);
  node.input_up(Line::first, 0_id, Time{});
  node.output_up(Line::first, 0_id, Time{});
  node.set_output_ready(Line::first, false);
  node.receive(Line::first, {wire::SliceKind::idle, {}}, Time{});
  node.send(send_of(1, 1, 0_id, data), Time{});
  node.interrupt({1, 2, 0_id, wire::Factor{1}}, Time{});
  node.pull(1, 3, 0, Time{});
  node.cancel(1, Time{});
  node.cpu_reset(1, Time{});
  node.set_cpu({}, Time{});
  node.set_cpu_present(true);
  node.handle_timeout(Time{});
  node.run(Time{});
  node.input_gap(Line::first, Time{});
  node.input_lost(Line::first, Time{});
  node.output_lost(Line::first, Time{});
  const auto of = [](const Input& input) { return input.index(); };
  EXPECT_THAT(journal.seen,
              ElementsAre(of(input::InputUp{}), of(input::OutputUp{}), of(input::OutputReady{}), of(input::Receive{}),
                          of(input::Send{}), of(input::Interrupt{}), of(input::Pull{}), of(input::Cancel{}),
                          of(input::CpuReset{}), of(input::Cpu{}), of(input::CpuPresent{}), of(input::Timeout{}),
                          of(input::Run{}), of(input::InputGap{}), of(input::InputLost{}), of(input::OutputLost{})));
}

}  // namespace
}  // namespace limb_ring::core
