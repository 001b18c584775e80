// The settings of their rings' files on which nodes must agree.
#include "node/link_settings.h"

#include <gtest/gtest.h>

#include <functional>

namespace limb_ring::setup {
namespace {

using config::RingConfig;
using namespace std::chrono_literals;

RingConfig two_nodes() {
  RingConfig ring;
  ring.ring = "two";
  for (const char* name : {"head", "neck"}) {
    config::NodeConfig node;
    node.id = static_cast<std::uint8_t>(ring.nodes.size());
    node.name = name;
    config::JointConfig joint;
    joint.name = node.name + "_pitch";
    node.joints.push_back(joint);
    ring.nodes.push_back(node);
  }
  return ring;
}

std::string said_of(const std::function<void(RingConfig&)>& change) {
  RingConfig other = two_nodes();
  change(other);
  const std::uint32_t differing = link::differences(agreement_of(two_nodes()), agreement_of(other));
  return differing == 0 ? "" : link::differing_parts(differing);
}

TEST(AgreementOf, NamesThePartThatDiffers) {
  EXPECT_EQ(said_of([](RingConfig&) {}), "");
  EXPECT_EQ(said_of([](RingConfig& r) { r.nodes[1].name = "collar"; }), "nodes differ");
  EXPECT_EQ(said_of([](RingConfig& r) { r.redundancy = RingConfig::Redundancy::foldback; }), "redundancy differs");
  EXPECT_EQ(said_of([](RingConfig& r) { r.timeouts.silence = 61ms; }), "timeouts differ");
  EXPECT_EQ(said_of([](RingConfig& r) { r.nodes[0].link.rate = 1; }), "lines differ");
  EXPECT_EQ(said_of([](RingConfig& r) { r.nodes[0].link.expected.delay = 1ms; }), "lines differ");
  EXPECT_EQ(said_of([](RingConfig& r) { r.nodes[0].joints[0].name = "head_yaw"; }), "joints differ");
  EXPECT_EQ(said_of([](RingConfig& r) { r.nodes[0].pins[3].action = config::PinConfig::Action::reset; }),
            "pins differ");
  EXPECT_EQ(said_of([](RingConfig& r) { r.supervisor.node = 1; }), "supervisor differs");
}

TEST(AgreementOf, KnowsTheOrderOfTheNodes) {
  EXPECT_NE(said_of([](RingConfig& r) { std::swap(r.nodes[0], r.nodes[1]); }).find("nodes"), std::string::npos);
}

TEST(AgreementOf, LeavesOutWhatMayDifferFromHostToHost) {
  EXPECT_EQ(said_of([](RingConfig& r) {
              r.realtime.cores = {3};
              r.limits.send_queue = 7;
              r.timeouts.command = 1s;
              r.nodes[0].link.address = "192.168.0.2";
              r.nodes[0].link.port = 4711;
              r.nodes[0].link.transport = config::LinkConfig::Transport::udp;
              r.nodes[0].cpu.command = {"/opt/knee"};
            }),
            "");
}

}  // namespace
}  // namespace limb_ring::setup
