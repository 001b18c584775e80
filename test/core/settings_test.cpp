// The defaults of a network controller. (protocol.md sections 7.2 and 7.3)
#include "core/settings.h"

#include "core/copied_state.h"

namespace limb_ring::core {
namespace {

using namespace std::chrono_literals;

TEST(Settings, HaveTheTimesOfTheTableOfTimersUnlessOthersAreGiven) {
  const Settings settings;
  EXPECT_EQ(settings.send_timeout_least, Duration{100ms});
  EXPECT_EQ(settings.refused_for, Duration{1s});
  EXPECT_EQ(settings.refused_backoff, Duration{1ms});
  EXPECT_EQ(settings.refused_backoff_most, Duration{64ms});
  EXPECT_EQ(settings.queue_timeout, Duration{5s});
  EXPECT_EQ(settings.stall, Duration{50ms});
  EXPECT_EQ(settings.beacon, Duration{100ms});
  EXPECT_EQ(settings.break_grace, Duration{200ms});
  EXPECT_EQ(settings.fold_permission, Duration{200ms});
}

TEST(Settings, HaveTheBuffersAndQueuesOfTheSpecificationUnlessOthersAreGiven) {
  const Settings settings;
  EXPECT_EQ(settings.insertion_buffer, 8u);
  EXPECT_EQ(settings.interrupt_buffer, 64u);
  EXPECT_EQ(settings.send_queue, 64u);
  EXPECT_EQ(settings.receive_buffers, 32u);
  EXPECT_EQ(settings.boot, 1u);
}

// Two INTPs at each node, which is as long as one may take.
TEST(Settings, SayHowOftenAnInterruptMayGoIntoAnOpenChain) {
  Settings settings;
  EXPECT_EQ(settings.open_chain_interrupt_pace(), Duration{100us});
  settings.order = {NodeId{0}, NodeId{1}, NodeId{2}};
  settings.byte_time_out = 10us;
  settings.relay_delay = 1us;
  EXPECT_EQ(settings.open_chain_interrupt_pace(), 3 * (24 * 10us + 1us));
}

TEST(Settings, AreWholeInARecording) {
  Settings before, after;
  before.break_grace = 1ms;
  before.fold_permission = 2ms;
  before.unconfirmed_pace = 3ms;
  before.inputs[4] = InterruptInput{NodeId{7}, wire::Factor{2}};
  read_state(bytes_of(before), after);
  EXPECT_EQ(after.break_grace, Duration{1ms});
  EXPECT_EQ(after.fold_permission, Duration{2ms});
  EXPECT_EQ(after.unconfirmed_pace, Duration{3ms});
  ASSERT_TRUE(after.inputs[4]);
  EXPECT_EQ(after.inputs[4]->destination, 7);
  EXPECT_EQ(after.inputs[4]->factor, 2);
}

TEST(Settings, AreOfALineThatTakesNoTimeUnlessARateIsGiven) {
  const Settings settings;
  EXPECT_EQ(settings.byte_time_in, Duration{0});
  EXPECT_EQ(settings.byte_time_out, Duration{0});
  EXPECT_EQ(settings.worst_lap(), Duration{0});
  EXPECT_EQ(settings.relay_delay, Duration{0});
  EXPECT_EQ(settings.all_delays, Duration{0});
}

}  // namespace
}  // namespace limb_ring::core
