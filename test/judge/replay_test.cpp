// What a flight recorder has recorded of a core is replayed exactly. LIMB_RING_REPLAYS=n: of n seeds.
#include <gtest/gtest.h>

#include <cstdlib>

#include "judge/recorded_lives.h"
#include "study/random_faults.h"
#include "support/packets.h"

namespace limb_ring::recorder {
namespace {

TEST(Replay, repeatsWhatRandomFaultsHaveDoneToNodes) {
  const char* fewer = std::getenv("LIMB_RING_REPLAYS");
  const std::uint64_t seeds = fewer ? std::strtoull(fewer, nullptr, 10) : 30;
  std::uint64_t halves = 0, lives = 0;
  for (std::uint64_t seed = 1; seed <= seeds && !HasFailure(); ++seed) {
    study::RandomFaults run(seed, study::RandomFaults::FoldBack::some,
                            seed % 2 == 0 ? study::RandomFaults::World::wide : study::RandomFaults::World::usual);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + run.describe());
    RecordedLives recorded(run.ring());
    run.run();
    for (const std::vector<std::uint8_t>& saved : recorded.end_all()) {
      EXPECT_EQ(in_words(replayed(saved)), "");
      halves += read_saved({saved.data(), saved.size()}).halves.back().generation;
      ++lives;
    }
  }
  EXPECT_GT(lives, 10 * seeds);
  EXPECT_GT(halves, 10 * lives) << "states in the middle of a life were gone on from, too";
}

/// A node of three with both its lines up.
core::Settings three() {
  core::Settings settings;
  settings.id = wire::NodeId{1};
  settings.order = {wire::NodeId{0}, wire::NodeId{1}, wire::NodeId{2}};
  return settings;
}

// Slots of packets are used again, also for what passed long before the state was written down: a core that goes on
// from that state has never seen it.
TEST(Replay, whatPassedBeforeAStateIsNotInALaterOne) {
  const core::Time before{std::chrono::milliseconds(1)}, later{std::chrono::milliseconds(2)};
  const wire::SliceKind start = wire::SliceKind::start;
  const std::uint8_t data = 7;
  test::DataPacket packet;
  packet.destination = wire::NodeId{2};
  packet.data = {&data, 1};
  const std::vector<std::uint8_t> bytes = encoded(packet);
  core::NetworkController node(three(), core::Time{});
  node.apply(core::input::InputUp{core::Line::first, wire::NodeId{0}}, before);
  node.apply(core::input::OutputUp{core::Line::first, wire::NodeId{2}}, before);
  node.set_output_ready(core::Line::first, false);
  node.receive(core::Line::first, {wire::SliceKind::whole, {bytes.data(), bytes.size()}}, before);
  node.set_output_ready(core::Line::first, true);
  node.apply(core::input::Run{}, before);
  node.output(core::Line::first).clear();

  const std::vector<std::uint8_t> state = bytes_of(node);
  core::NetworkController other(three(), core::Time{});
  core::StateReader reader({state.data(), state.size()});
  other.archive(reader);
  ASSERT_TRUE(reader.complete());
  node.receive(core::Line::first, {start, {bytes.data(), wire::kHeaderSize}}, later);
  other.receive(core::Line::first, {start, {bytes.data(), wire::kHeaderSize}}, later);
  EXPECT_EQ(bytes_of(node), bytes_of(other));
}

}  // namespace
}  // namespace limb_ring::recorder
