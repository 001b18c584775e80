#include "config/ring_text.h"

namespace limb_ring::config {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(RingFile, WithOnlyNodesHasTheDefaults) {
  const RingConfig ring = read(two_nodes());
  EXPECT_EQ(ring.ring, "pair");
  EXPECT_EQ(ring.path, "ring.yaml");
  ASSERT_EQ(ring.nodes.size(), 2u);
  EXPECT_EQ(ring.limits.insertion_buffer, std::nullopt);
  EXPECT_EQ(ring.timeouts.send, 100ms);
  EXPECT_EQ(ring.firmware.state_rate, 100.0);
  EXPECT_EQ(ring.bridge.rate, 50.0);
  EXPECT_EQ(ring.realtime.fifo, 0);
}

TEST(RingFile, SetsTheVirtualClock) {
  EXPECT_EQ(read(two_nodes()).virtual_clock.boot_time, 20ms);
  EXPECT_TRUE(read(two_nodes()).bridge.lockstep.empty());
  const RingConfig ring = read(two_nodes("virtual: {boot_time: 5ms, stall: 1s, seed: 9}\nbridge: {lockstep: true}\n"));
  EXPECT_EQ(ring.virtual_clock.boot_time, 5ms);
  EXPECT_EQ(ring.virtual_clock.stall, 1s);
  EXPECT_EQ(ring.virtual_clock.seed, 9u);
  EXPECT_EQ(ring.bridge.lockstep, std::vector<std::string>{"joint_commands"});
}

TEST(RingFile, NamesTheTopicsOfControllersInLockstep) {
  using Topics = std::vector<std::string>;
  const RingConfig ring = read(two_nodes("bridge: {lockstep: [arms/commands, legs], phase: 150us}\n"));
  EXPECT_EQ(ring.bridge.lockstep, (Topics{"arms/commands", "legs"}));
  EXPECT_EQ(ring.bridge.phase, 150us);
  EXPECT_TRUE(read(two_nodes("bridge: {lockstep: false}\n")).bridge.lockstep.empty());
  EXPECT_TRUE(read(two_nodes("bridge: {lockstep: []}\n")).bridge.lockstep.empty());
  EXPECT_FALSE(read(two_nodes()).bridge.phase);
}

TEST(RingFile, SetsLimitsAndTimeouts) {
  const RingConfig ring =
      read(two_nodes("limits: {insertion_buffer: 2, interrupt_buffer: 3, send_queue: 4, receive_buffers: 5, "
                     "clients: 6}\n"
                     "timeouts: {send: 1ms, refused: 2s, refused_backoff: 3ms, queue: 4ms, stall: 5ms, idle: "
                     "6ms,\n"
                     "           silence: 70ms, first_successor: 8ms, break_grace: 9ms, fold_permission: 12ms, beacon: "
                     "90ms, cpu_boot: 10s, command: 11ms}\n"));
  EXPECT_EQ(ring.limits.insertion_buffer, 2u);
  EXPECT_EQ(ring.limits.interrupt_buffer, 3u);
  EXPECT_EQ(ring.limits.send_queue, 4u);
  EXPECT_EQ(ring.limits.receive_buffers, 5u);
  EXPECT_EQ(ring.limits.clients, 6u);
  EXPECT_EQ(ring.timeouts.send, 1ms);
  EXPECT_EQ(ring.timeouts.refused, 2s);
  EXPECT_EQ(ring.timeouts.refused_backoff, 3ms);
  EXPECT_EQ(ring.timeouts.queue, 4ms);
  EXPECT_EQ(ring.timeouts.stall, 5ms);
  EXPECT_EQ(ring.timeouts.idle, 6ms);
  EXPECT_EQ(ring.timeouts.silence, 70ms);
  EXPECT_EQ(ring.timeouts.first_successor, 8ms);
  EXPECT_EQ(ring.timeouts.break_grace, 9ms);
  EXPECT_EQ(ring.timeouts.fold_permission, 12ms);
  EXPECT_EQ(ring.timeouts.beacon, 90ms);
  EXPECT_EQ(ring.timeouts.cpu_boot, 10s);
  EXPECT_EQ(ring.timeouts.command, 11ms);
}

TEST(RingFile, SetsFirmwareBridgeAndRealtime) {
  const RingConfig ring =
      read(two_nodes("firmware: {state_rate: 250, bandwidth: 12.5, damping: 1}\n"
                     "bridge: {rate: 25}\n"
                     "realtime: {cores: [0, 2], fifo: 40, lock_memory: true, spin: 50us}\n"));
  EXPECT_EQ(ring.firmware.state_rate, 250.0);
  EXPECT_EQ(ring.firmware.bandwidth, 12.5);
  EXPECT_EQ(ring.firmware.damping, 1.0);
  EXPECT_EQ(ring.bridge.rate, 25.0);
  EXPECT_THAT(ring.realtime.cores, ElementsAre(0u, 2u));
  EXPECT_EQ(ring.realtime.fifo, 40);
  EXPECT_TRUE(ring.realtime.lock_memory);
  EXPECT_EQ(ring.realtime.spin, 50us);
  EXPECT_FALSE(ring.realtime.auto_cores);
}

TEST(RingFile, ChoosesTheCoresIfTheyAreAuto) {
  EXPECT_TRUE(read(two_nodes("realtime: {cores: auto}\n")).realtime.auto_cores);
}

TEST(RingFile, LinksAreTheDefaultOfEveryNodeWhereverTheyStand) {
  const RingConfig ring = read(
      "nodes:\n"
      "  - {id: 3, name: body}\n"
      "  - {id: 7, name: knee, link: {rate: unlimited, port: 5000, address: 127.0.0.2}}\n"
      "links: {transport: udp, port: 20000, rate: 10Mbit/s, delay: 512ns}\n"
      "ring: pair\n");
  const LinkConfig body = ring.nodes[0].link, knee = ring.nodes[1].link;
  EXPECT_EQ(body.transport, LinkConfig::Transport::udp);
  EXPECT_EQ(body.address, "127.0.0.1");
  EXPECT_EQ(body.port, 20003);
  EXPECT_EQ(body.rate, 10000000u);
  EXPECT_EQ(body.delay, 512ns);
  EXPECT_EQ(knee.transport, LinkConfig::Transport::udp);
  EXPECT_EQ(knee.address, "127.0.0.2");
  EXPECT_EQ(knee.port, 5000);
  EXPECT_EQ(knee.rate, 0u);
  EXPECT_EQ(knee.delay, 512ns);
}

TEST(RingFile, NodesKeepTheFilesOrder) {
  const RingConfig ring = read("ring: r\nnodes: [{id: 9, name: c}, {id: 0, name: a}, {id: 254, name: b}]\n");
  ASSERT_EQ(ring.nodes.size(), 3u);
  EXPECT_EQ(ring.nodes[0].id, 9);
  EXPECT_EQ(ring.nodes[1].id, 0);
  EXPECT_EQ(ring.nodes[2].id, 254);
}

TEST(RingFile, MayHoldTheLargestRing) {
  std::string text = "ring: r\nnodes:\n";
  for (int id = 0; id < 255; ++id) text += "  - {id: " + std::to_string(id) + "}\n";
  EXPECT_EQ(read(text).nodes.size(), 255u);
}

TEST(RingFile, TopicsNameTheirNodesByNameOrId) {
  const RingConfig ring = read(
      "ring: r\n"
      "bridge:\n"
      "  topics:\n"
      "    - {input: camera, from: head, to: 0, priority: 2, queue: 9}\n"
      "    - {input: wrench, output: /head/wrench, from: 0, to: head}\n"
      "nodes: [{id: 0, name: body, cpu: attached}, {id: 5, name: head, cpu: attached}]\n");
  ASSERT_EQ(ring.bridge.topics.size(), 2u);
  const TopicConfig& camera = ring.bridge.topics[0];
  EXPECT_EQ(camera.input, "camera");
  EXPECT_EQ(camera.output, "camera");
  EXPECT_EQ(camera.from, 5);
  EXPECT_EQ(camera.to, 0);
  EXPECT_EQ(camera.priority, 2);
  EXPECT_EQ(camera.queue, 9u);
  EXPECT_EQ(ring.bridge.topics[1].output, "/head/wrench");
  EXPECT_EQ(ring.bridge.topics[1].priority, 3);
}

TEST(RingFile, NodesAreFoundByIdAndName) {
  const RingConfig ring = read(two_nodes());
  EXPECT_EQ(ring.find(1), &ring.nodes[1]);
  EXPECT_EQ(ring.find("1"), &ring.nodes[1]);
  EXPECT_EQ(ring.find("knee"), &ring.nodes[1]);
  EXPECT_EQ(ring.find(2), nullptr);
  EXPECT_EQ(ring.find("kne"), nullptr);
}

}  // namespace
}  // namespace limb_ring::config
