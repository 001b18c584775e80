// Traffic that the daemon itself makes, on a virtual ring.
#include "node/event_router.h"

#include <gtest/gtest.h>

#include "node/virtual_node.h"
#include "support/node_literal.h"

namespace limb_ring::virtual_host {
namespace {

using namespace std::chrono_literals;

/// Hands the ends of sends to the traffic, as a node does.
struct Ends final : runtime::DriverListener {
  void on_event(const core::Event& event) override {
    if (const auto* ended = std::get_if<core::SendEnded>(&event.what)) traffic->on_ended(*ended, "because");
  }
  void on_round_end() override {}
  void on_link(const runtime::LinkChange&) override {}

  runtime::Traffic* traffic = nullptr;
};

struct TrafficTest : testing::Test {
  TrafficTest() {
    ends.traffic = &traffic;
    ring.on_event = [this](wire::NodeId, const core::Event& event) { node.on_event(event); };
  }

  sim::VirtualRing ring{sim::VirtualRingOptions{}};
  sim::VirtualLineFaults faults{ring, 1};
  Ends ends;
  VirtualNode node{{ring, faults, [] {}}, 1_id, ends};
  runtime::Traffic traffic{node};
};

TEST_F(TrafficTest, WhatIsRejectedIsSentAgainAfterAPauseAndTimeGoesOn) {
  runtime::TrafficRequest request;
  request.to = 2_id;
  request.size = 0;  // the node rejects it at once
  request.count = runtime::Traffic::kMostPackets;
  request.duration = 20ms;
  nlohmann::json report;
  ASSERT_TRUE(traffic.start(request, [&](const nlohmann::json& told) { report = told; }));
  ring.run_until(ring.now());
  EXPECT_TRUE(report.is_null());
  ring.run_for(30ms);
  ASSERT_FALSE(report.is_null());
  EXPECT_EQ(report["other"]["rejected"], report["sent"]);
  EXPECT_LE(report["sent"], 21);
}

}  // namespace
}  // namespace limb_ring::virtual_host
