// Two nodes in one process, on slow lines.
#include "node/engine.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <variant>
#include <vector>

#include "config/core_settings.h"
#include "config/load_ring.h"
#include "support/node_literal.h"
#include "support/run_until.h"
#include "support/temporary_folder.h"

namespace limb_ring::runtime {
namespace {

constexpr core::Owner kOwner = 100;

/// Keeps what state the node is in, and the tokens of what has ended.
struct Seen : DriverListener {
  void on_event(const core::Event& event) override {
    const auto* change = std::get_if<core::StateChanged>(&event.what);
    if (change != nullptr) state = change->after;
    const auto* ended = std::get_if<core::SendEnded>(&event.what);
    if (ended != nullptr && ended->owner == kOwner) tokens.push_back(ended->token);
  }
  void on_round_end() override {}
  void on_link(const LinkChange&) override {}

  core::NodeState state = core::NodeState::starting;
  std::vector<std::uint32_t> tokens;
};

class TwoEngines : public ::testing::Test {
 protected:
  TwoEngines() {
    for (std::size_t i = 0; i < 2; ++i) {
      const config::NodeConfig& node = ring_.nodes[i];
      nodes_.push_back(std::make_unique<Engine>(io_, setup::core_settings(ring_, node, 1),
                                                setup::link_settings(ring_, node, folder_.path()), seen_[i]));
    }
  }

  bool until(const std::function<bool()>& condition) { return test::run_until(io_, condition); }
  bool is_up(std::size_t node) const { return seen_[node].state == core::NodeState::up; }

  test::TemporaryFolder folder_;
  const config::RingConfig ring_ = config::parse_ring(R"(
ring: slow
links: {transport: unix, rate: 1Mbit/s}
timeouts: {send: 10s, stall: 5s, silence: 10s}
nodes: [{id: 0}, {id: 1}]
)",
                                                      "slow.yaml");
  Seen seen_[2];
  boost::asio::io_context io_;
  std::vector<std::unique_ptr<Engine>> nodes_;
};

TEST_F(TwoEngines, APacketIsUnderWayInPumpAroundHoweverLongItTakes) {
  ASSERT_TRUE(until([&] { return is_up(0) && is_up(1); }));
  Engine& sender = *nodes_[0];
  const std::vector<std::uint8_t> data(512);

  core::SendRequest send;
  send.owner = kOwner;
  send.token = 1;
  send.destination = 1_id;
  send.data = {data.data(), data.size()};
  sender.controller().apply(core::input::Send{send}, sender.now());
  sender.pump_around([&](core::Time now) {
    const auto enough = std::chrono::milliseconds(10);  // the packet passes in 4.2 ms
    const auto end = std::chrono::steady_clock::now() + enough;
    while (std::chrono::steady_clock::now() < end) std::this_thread::yield();
    sender.controller().apply(core::input::Interrupt{{kOwner, 2, 1_id, wire::Factor{0}}}, now);
  });

  ASSERT_TRUE(until([&] { return seen_[0].tokens.size() == 2; }));
  EXPECT_EQ(seen_[0].tokens, (std::vector<std::uint32_t>{2, 1}));
}

}  // namespace
}  // namespace limb_ring::runtime
