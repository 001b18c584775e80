#include "node/steering.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace limb_ring::virtual_host {
namespace {

using namespace std::chrono_literals;
using testing::Each;
using testing::ElementsAre;

/// What came through, and when.
struct Calls final : host::HostHandler {
  explicit Calls(sim::VirtualRing& on) : ring(on) {}

  std::optional<std::string> on_attach(const host::ClientInfo&) override { return std::nullopt; }
  void on_detach(const host::ClientInfo&) override {}
  void on_send(host::ClientId, const client::SendRequest& request) override {
    note("send " + std::string(request.data.begin(), request.data.end()));
  }
  void on_interrupt(host::ClientId, const client::InterruptRequest&) override { note("interrupt"); }
  void on_pull(host::ClientId, const client::PullRequest&) override { note("pull"); }
  void on_request(host::ClientId, const client::JsonRequest&) override { note("request"); }
  void on_observe(host::ClientId, const client::ObserveRequest&) override {}
  void on_alive(host::ClientId) override {}
  void on_credit(host::ClientId) override {}

  void note(const std::string& call) {
    what.push_back(call);
    at.push_back(std::chrono::duration_cast<std::chrono::nanoseconds>(ring.now().time_since_epoch()));
  }

  sim::VirtualRing& ring;
  std::vector<std::string> what;
  std::vector<std::chrono::nanoseconds> at;
};

struct TurnaroundTest : testing::Test {
  void attach(Turnaround& turnaround, bool lockstep) {
    info.id = 1;
    info.role = Role::cpu;
    info.lockstep = lockstep;
    turnaround.on_attach(info);
  }
  static void send(Turnaround& turnaround, const std::string& text) {
    client::SendRequest request;
    request.data = {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
    turnaround.on_send(1, request);
  }
  config::CpuConfig cpu(std::chrono::nanoseconds turnaround, std::chrono::nanoseconds jitter) {
    config::CpuConfig config;
    config.turnaround = turnaround;
    config.jitter = jitter;
    return config;
  }
  std::vector<std::chrono::nanoseconds> instants_of(std::uint64_t seed) {
    sim::VirtualRing own{sim::VirtualRingOptions{}};
    VirtualClock its_clock(own);
    Calls entered(own);
    Turnaround turnaround(entered, own, its_clock, cpu(10us, 5us), seed);
    attach(turnaround, true);
    for (int i = 0; i < 20; ++i) {
      send(turnaround, "x");
      own.run_for(1ms);
    }
    return entered.at;
  }

  sim::VirtualRing ring{sim::VirtualRingOptions{}};
  VirtualClock clock{ring};
  Calls calls{ring};
  host::ClientInfo info;
};

TEST_F(TurnaroundTest, WhatIsSentInATurnEntersInOrderAndLater) {
  Turnaround turnaround(calls, ring, clock, cpu(40us, 0us), 1);
  attach(turnaround, true);
  send(turnaround, "a");
  turnaround.on_interrupt(1, {});
  send(turnaround, "b");
  turnaround.on_request(1, {});
  ring.run_for(1ms);
  EXPECT_THAT(calls.what, ElementsAre("request", "send a", "interrupt", "send b"));
  EXPECT_THAT(calls.at, ElementsAre(0us, 40us, 40us, 40us));
}

TEST_F(TurnaroundTest, WhatAToolSendsEntersAtOnce) {
  Turnaround turnaround(calls, ring, clock, cpu(40us, 0us), 1);
  attach(turnaround, false);
  send(turnaround, "a");
  EXPECT_THAT(calls.at, ElementsAre(0us));
}

TEST_F(TurnaroundTest, ACpuThatIsGoneSendsNothingMore) {
  Turnaround turnaround(calls, ring, clock, cpu(40us, 0us), 1);
  attach(turnaround, true);
  send(turnaround, "a");
  turnaround.on_detach(info);
  ring.run_for(1ms);
  EXPECT_THAT(calls.what, testing::IsEmpty());
}

TEST_F(TurnaroundTest, JitterIsWithinItsBoundAndTheSameForTheSameSeed) {
  const auto instants = instants_of(7);
  EXPECT_EQ(instants_of(7), instants);
  EXPECT_NE(instants_of(8), instants);
  std::vector<std::chrono::nanoseconds> late;
  for (std::size_t i = 0; i < instants.size(); ++i) late.push_back(instants[i] - i * 1ms);
  EXPECT_THAT(late, Each(testing::AllOf(testing::Ge(10us), testing::Le(15us))));
}

}  // namespace
}  // namespace limb_ring::virtual_host
