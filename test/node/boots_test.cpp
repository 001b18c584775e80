// CPUs of a virtual ring that boot: whom its clock waits for.
#include "node/lockstep.h"

#include <gtest/gtest.h>

namespace limb_ring::virtual_host {
namespace {

using namespace std::chrono_literals;

struct BootsTest : testing::Test {
  BootsTest() {
    config::NodeConfig node;
    node.id = 1;
    node.cpu.kind = config::CpuConfig::Kind::child;
    config.nodes.push_back(node);
    config.virtual_clock.boot_time = 5ms;
  }
  void boots(pid_t pid) {
    runtime::CpuStatus cpu;
    cpu.kind = runtime::CpuKind::child;
    cpu.state = wire::CpuState::booting;
    cpu.pid = pid;
    waited_for.changed(1, cpu);
  }
  void greets() {
    waited_for.greeted(1, [this] { ++attached; });
  }

  sim::VirtualRing ring{sim::VirtualRingOptions{}};
  config::RingConfig config;
  Boots waited_for{ring, config, [](std::uint8_t) { return false; }};
  int attached = 0;
};

TEST_F(BootsTest, ACpuThatHasGreetedIsAttachedWhenItsBootIsOver) {
  boots(100);
  greets();
  EXPECT_EQ(waited_for.held_at(), core::Time{} + 5ms);
  waited_for.attach_those_due();
  EXPECT_EQ(attached, 0);
  ring.run_for(5ms);
  EXPECT_TRUE(waited_for.attach_those_due());
  EXPECT_EQ(attached, 1);
  EXPECT_EQ(waited_for.held_at(), core::kNever);
}

TEST_F(BootsTest, ACpuThatHasGreetedAndLeftIsWaitedForAgain) {
  boots(100);
  greets();
  waited_for.left(1);
  ring.run_for(5ms);
  EXPECT_FALSE(waited_for.attach_those_due());
  greets();
  EXPECT_TRUE(waited_for.attach_those_due());
  EXPECT_EQ(attached, 1);
}

TEST_F(BootsTest, AClientThatGreetedInPlaceOfAChildThatIsGoneDoesNotWaitForEver) {
  boots(100);
  greets();
  boots(-1);
  EXPECT_EQ(attached, 1);
  EXPECT_EQ(waited_for.held_at(), core::kNever);
}

}  // namespace
}  // namespace limb_ring::virtual_host
