#include "config/ring_text.h"

namespace limb_ring::config {
namespace {

using ::testing::AllOf;
using ::testing::Eq;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// What is added to node_with() begins in line 5, and belongs to nodes[1].

TEST(WrongNodes, NoneOrOneOrTooMany) {
  EXPECT_THAT(refusal_of("ring: r\n"), HasSubstr("'nodes' is missing"));
  EXPECT_THAT(refusal_of("ring: r\nnodes: []\n"),
              StartsWith("ring.yaml:2:8: entry 'nodes': a list of 0 is too short; allowed: a list of "
                         "2 to 255 nodes"));
  EXPECT_THAT(refusal_of("ring: r\nnodes: [{id: 0}]\n"), HasSubstr("a list of 1 is too short"));
  std::string many = "ring: r\nnodes:\n";
  for (int i = 0; i < 256; ++i) many += "  - {id: 0}\n";
  EXPECT_THAT(refusal_of(many), HasSubstr("a list of 256 is too long"));
}

TEST(WrongNodes, NoListOrNoMaps) {
  EXPECT_THAT(refusal_of("ring: r\nnodes: {id: 0}\n"), HasSubstr("'nodes': a map is not a list"));
  EXPECT_THAT(refusal_of("ring: r\nnodes: [body, knee]\n"),
              StartsWith("ring.yaml:2:9: entry 'nodes[0]': 'body' is not a map"));
}

TEST(WrongNodes, IdMissingOutOfRangeOrTwice) {
  EXPECT_THAT(refusal_of("ring: r\nnodes:\n  - {id: 0}\n  - {name: a}\n"),
              StartsWith("ring.yaml:4:5: entry 'nodes[1]': 'id' is missing; allowed: a map of id"));
  EXPECT_THAT(refusal_of("ring: r\nnodes: [{id: 0}, {id: 255}]\n"),
              HasSubstr("'nodes[1].id': '255' is out of range; allowed: a whole number, 0 to 254"));
  EXPECT_THAT(refusal_of("ring: r\nnodes:\n  - {id: 3}\n  - {id: 3}\n"),
              Eq("ring.yaml:4:10: entry 'nodes[1].id': '3' is the id of another node; allowed: ids 0 to "
                 "254, each once"));
  EXPECT_THAT(refusal_of("ring: r\nnodes:\n  - {id: 3, name: a}\n  - {id: 3, name: a}\n"),
              AllOf(HasSubstr("'3' is the id of another node"), HasSubstr("'a' is the name of another node")));
}

TEST(WrongNodes, ForeignBesideSharedMemory) {
  EXPECT_THAT(refusal_of("ring: r\nnodes: [{id: 0}, {id: 1, controller: foreign}]\n"),
              HasSubstr("its controller is foreign, and the link into node 'node1' is shm; allowed: links beside it"));
  EXPECT_THAT(refusal_of("ring: r\nlinks: {transport: udp}\n"
                         "nodes: [{id: 0, link: {transport: shm}}, {id: 1, controller: foreign}]\n"),
              HasSubstr("the link into node 'node0' is shm"));
}

TEST(WrongNodes, NameUnfitOrTwice) {
  EXPECT_THAT(refusal_of(node_with("    name: 12\n")),
              AllOf(StartsWith("ring.yaml:5:11: entry 'nodes[1].name': '12' is not a name"),
                    HasSubstr("allowed: a letter, then")));
  EXPECT_THAT(refusal_of(node_with("    name: all\n")), HasSubstr("not the word 'all'"));
  EXPECT_THAT(refusal_of(node_with("    name: knee\n")),
              StartsWith("ring.yaml:5:11: entry 'nodes[1].name': 'knee' is the name of another node"));
  EXPECT_THAT(refusal_of("ring: r\nnodes: [{id: 0, name: node1}, {id: 1}]\n"),
              HasSubstr("entry 'nodes[1]': 'node1' is the name of another node"));
}

TEST(WrongNodes, UnknownEntry) {
  EXPECT_THAT(refusal_of(node_with("    joint: []\n")),
              StartsWith("ring.yaml:5:5: entry 'nodes[1].joint': is unknown, did you mean 'joints'?; "
                         "allowed: id, name, host, controller, library, cpu, joints"));
}

TEST(WrongNodes, Cpu) {
  EXPECT_THAT(refusal_of(node_with("    cpu: yes\n")),
              HasSubstr("'nodes[1].cpu': 'yes' is unknown; allowed: none, attached or {command:"));
  EXPECT_THAT(refusal_of(node_with("    cpu: [a]\n")), HasSubstr("a list stands here"));
  EXPECT_THAT(refusal_of(node_with("    cpu: {}\n")), HasSubstr("'command' is missing"));
  EXPECT_THAT(refusal_of(node_with("    cpu: {command: []}\n")), HasSubstr("'nodes[1].cpu.command': names no program"));
  EXPECT_THAT(refusal_of(node_with("    cpu: {command: limb_firmware}\n")),
              HasSubstr("'limb_firmware' is not a list; allowed: a list of program and arguments"));
  EXPECT_THAT(refusal_of(node_with("    cpu: {command: [a], restart: true}\n")),
              HasSubstr("'nodes[1].cpu.restart': is unknown"));
}

TEST(WrongNodes, CpuThatIsBothStartedAndAttached) {
  EXPECT_THAT(refusal_of(node_with("    cpu: {command: [a], attached: true}\n")),
              StartsWith("ring.yaml:5:10: entry 'nodes[1].cpu': command and attached are both given; allowed: one"));
  EXPECT_THAT(refusal_of(node_with("    cpu: {attached: false}\n")), HasSubstr("'command' is missing"));
  EXPECT_THAT(refusal_of(node_with("    cpu: {command: [a], alive_period: 61s}\n")),
              HasSubstr("'nodes[1].cpu.alive_period': '61s' is out of range"));
}

TEST(WrongNodes, Joints) {
  EXPECT_THAT(refusal_of(node_with("    joints: {name: a}\n")), HasSubstr("a map is not a list"));
  EXPECT_THAT(refusal_of(node_with("    joints: [{lower: 0}]\n")),
              HasSubstr("'nodes[1].joints[0]': 'name' is missing"));
  EXPECT_THAT(refusal_of(node_with("    joints: [{name: a, lower: 1, upper: 1}]\n")),
              HasSubstr("joint 'a' has the limits 1 to 1 rad; allowed: lower less than upper"));
  EXPECT_THAT(refusal_of(node_with("    joints: [{name: a, lower: 1, upper: 2, initial: 0}]\n")),
              HasSubstr("joint 'a' has initial 0, outside its limits; allowed: 1 to 2 rad"));
  EXPECT_THAT(refusal_of(node_with("    joints: [{name: a, type: prismatic, initial: 1.5}]\n")),
              HasSubstr("joint 'a' has initial 1.5, outside its limits; allowed: -1 to 1 m"));
  EXPECT_THAT(refusal_of(node_with("    joints: [{name: a, safe: float}]\n")),
              HasSubstr("'nodes[1].joints[0].safe': 'float' is unknown; allowed: hold, damp"));
  EXPECT_THAT(refusal_of(node_with("    joints: [{name: a, lower: low}]\n")),
              HasSubstr("'low' is not a number; allowed: a number, -2147 to 2147 rad or m"));
}

TEST(WrongNodes, JointsOrSensorsOfOneName) {
  EXPECT_THAT(refusal_of("ring: r\nnodes:\n  - {id: 0, joints: [{name: a}]}\n"
                         "  - {id: 1, joints: [{name: b}, {name: a}]}\n"),
              StartsWith("ring.yaml:4:33: entry 'nodes[1].joints[1]': 'a' is the name of another one"));
  EXPECT_THAT(refusal_of(node_with("    sensors: [{name: a}, {name: a}]\n")),
              HasSubstr("'nodes[1].sensors[1]': 'a' is the name of another one"));
}

TEST(WrongNodes, JointsOrSensorsWithoutACpu) {
  EXPECT_THAT(refusal_of(node_with("    joints: [{name: a}]\n")),
              StartsWith("ring.yaml:5:14: entry 'nodes[1].joints[0]': joint 'a' needs a CPU: node 'node0' has "
                         "cpu: none; allowed: a cpu for this node: {command: [limb_firmware]}, or attached"));
  EXPECT_THAT(refusal_of(node_with("    cpu: none\n    sensors: [{name: b}]\n")),
              HasSubstr("'nodes[1].sensors[0]': sensor 'b' needs a CPU"));
  EXPECT_EQ(refusal_of(node_with("    cpu: attached\n    joints: [{name: a}]\n")), "");
}

TEST(WrongNodes, Sensors) {
  EXPECT_THAT(refusal_of(node_with("    sensors: [{name: a, kind: camera}]\n")),
              HasSubstr("'camera' is unknown; allowed: imu, force"));
  EXPECT_THAT(refusal_of(node_with("    sensors: [{name: foot-force}]\n")),
              Eq("ring.yaml:5:22: entry 'nodes[1].sensors[0].name': 'foot-force' is not a name that can be used here; "
                 "allowed: a letter, then letters, digits and '_', 64 at most"));
  EXPECT_THAT(refusal_of(node_with("    sensors: [{name: foot.force}]\n")), HasSubstr("is not a name"));
  EXPECT_THAT(refusal_of(node_with("    sensors: [{name: a, priority: 4}]\n")),
              HasSubstr("'4' is out of range; allowed: a whole number, 0 to 3"));
  EXPECT_THAT(refusal_of(node_with("    sensors: [{name: a, rate: 0}]\n")),
              HasSubstr("'0' is out of range; allowed: a number, 0.1 to 1000 Hz"));
}

TEST(WrongNodes, SensorsWithATopic) {
  const auto refusal_with = [](const std::string& topic) {
    return refusal_of(node_with("    cpu: {command: [f]}\n    sensors: [{name: a, " + topic + "}]\n"));
  };
  EXPECT_EQ(refusal_with("topic: gazebo/imu"), "");
  EXPECT_THAT(refusal_with("topic: ~imu"), HasSubstr("'~imu' is not a name that can be used here"));
  EXPECT_THAT(refusal_with("topic: sensors/a"),
              HasSubstr("'sensors/a' is where the readings of this sensor are published; allowed: the topic of whoever "
                        "measures, such as imu/data"));
  EXPECT_THAT(refusal_with("csv: ring.yaml, topic: b"), HasSubstr("there is no file"));
  EXPECT_THAT(refusal_with("csv: /proc/self/stat, topic: b"), HasSubstr("'a' has a csv and a topic; allowed: one"));
  EXPECT_THAT(refusal_of("ring: r\nnodes:\n  - {id: 0, cpu: attached, sensors: [{name: a, topic: b}]}\n  - {id: 1}\n"),
              HasSubstr("'nodes[0].sensors[0].topic': node 'node0' is the body, whose CPU hands out the values of "
                        "topics; allowed: a topic for sensors of other nodes"));
}

TEST(WrongNodes, Pins) {
  EXPECT_THAT(refusal_of(node_with("    pins: {3: restart}\n")), HasSubstr("'nodes[1].pins.3': 'restart' is unknown"));
  EXPECT_THAT(refusal_of(node_with("    pins: {8: reset}\n")), HasSubstr("'nodes[1].pins.8': is unknown"));
  EXPECT_THAT(refusal_of(node_with("    pins: [reset]\n")), HasSubstr("a list is not a map"));
  EXPECT_THAT(refusal_of(node_with("    pins: {3: signal}\n")), HasSubstr("'signal' needs a value"));
  EXPECT_THAT(refusal_of(node_with("    pins: {3: {}}\n")), HasSubstr("the map is empty"));
  EXPECT_THAT(refusal_of(node_with("    pins: {3: {signal: SEGV}}\n")),
              HasSubstr("'nodes[1].pins.3.signal': 'SEGV' is unknown; allowed: HUP, INT"));
  EXPECT_THAT(refusal_of(node_with("    pins: {3: {signal: HUP, exec: [a]}}\n")),
              HasSubstr("signal and exec are both given"));
  EXPECT_THAT(refusal_of(node_with("    pins: {3: {exec: []}}\n")), HasSubstr("names no program"));
}

TEST(WrongNodes, Inputs) {
  EXPECT_THAT(refusal_of(node_with("    inputs: {0: {to: kne, factor: 1}}\n")),
              AllOf(HasSubstr("'nodes[1].inputs.0.to': 'kne' is not a node of this ring, did you mean 'knee'?"),
                    HasSubstr("allowed: id or name of a node of this ring (knee, node0), or all")));
  EXPECT_THAT(refusal_of(node_with("    inputs: {0: {to: knee}}\n")), HasSubstr("'factor' is missing"));
  EXPECT_THAT(refusal_of(node_with("    inputs: {0: {to: knee, factor: 8}}\n")),
              HasSubstr("'8' is out of range; allowed: a whole number, 0 to 7"));
  EXPECT_THAT(refusal_of(node_with("    inputs: {9: {to: knee, factor: 1}}\n")),
              HasSubstr("'nodes[1].inputs.9': is unknown"));
}

TEST(WrongNodes, AnInputThatWouldResetAll) {
  EXPECT_THAT(refusal_of(node_with("    inputs: {4: {to: all, factor: 0}}\n")),
              AllOf(HasSubstr("'nodes[1].inputs.4': to all with factor 0 would reset CPUs"),
                    HasSubstr("allowed: one node, or a factor that no node has wired to reset")));
}

TEST(WrongNodes, AStopOfAllThatWouldNotStopThemOrResetThem) {
  const auto pins_of_knee = [](const std::string& pins) { return refusal_of(node_with("    pins: " + pins + "\n")); };
  EXPECT_THAT(pins_of_knee("{1: reset, 2: stop}"),
              AllOf(HasSubstr("'nodes[1]': its first pin wired to stop is 2, and pin 1 is node 'knee's for stop: a "
                              "broadcast to all would not stop it"),
                    HasSubstr("allowed: pin 1 wired to stop at every node that has such a pin, and to reset at none")));
  EXPECT_THAT(pins_of_knee("{1: reset}"), HasSubstr("'nodes[1]': its pin 1 is wired to reset, and pin 1 is node"));
  EXPECT_THAT(pins_of_knee("{2: none, 3: sync}"), HasSubstr("its first pin wired to sync is 3"));
  EXPECT_EQ(pins_of_knee("{1: none}"), "");  // nothing to stop there
}

TEST(WrongNodes, TwoLinksAtOnePort) {
  EXPECT_THAT(refusal_of("ring: r\nnodes:\n  - {id: 0, name: a, link: {port: 5000}}\n"
                         "  - {id: 1, name: b, link: {port: 5000}}\n"),
              StartsWith("ring.yaml:4:5: entry 'nodes[1]': its link listens at 127.0.0.1 port 5000, "
                         "as does node 'a'; allowed: a port of its own"));
}

/// A ring with a bridge at body, and this as its only topics.
std::string with_topics(const std::string& topics) {
  return "ring: r\n"
         "nodes: [{id: 0, name: body, cpu: attached}, {id: 1, name: head, cpu: attached}, {id: "
         "2}]\n"
         "bridge:\n"
         "  topics:\n" +
         topics;
}

TEST(WrongTopics, NodesThatAreUnknownTheSameOrWithoutBridge) {
  EXPECT_THAT(refusal_of(with_topics("    - {input: a, from: body, to: had}\n")),
              StartsWith("ring.yaml:5:34: entry 'bridge.topics[0].to': 'had' is not a node of this ring, did "
                         "you mean 'head'?"));
  EXPECT_THAT(refusal_of(with_topics("    - {input: a, from: body, to: 0}\n")),
              HasSubstr("'bridge.topics[0]': the topic goes from a node to itself"));
  EXPECT_THAT(refusal_of(with_topics("    - {input: a, from: body, to: 2}\n")),
              HasSubstr("'bridge.topics[0].to': node 'node2' has cpu: none, so no bridge"));
}

TEST(WrongTopics, NamesThatAreMissingUnfitOrTaken) {
  EXPECT_THAT(refusal_of(with_topics("    - {from: body, to: head}\n")), HasSubstr("'input' is missing"));
  EXPECT_THAT(refusal_of(with_topics("    - {input: a b, from: body, to: head}\n")),
              HasSubstr("'a b' is not a name that can be used here; allowed: a ROS topic name"));
  EXPECT_THAT(refusal_of(with_topics("    - {input: a, from: body, to: head}\n"
                                     "    - {input: b, output: a, from: body, to: head}\n")),
              StartsWith("ring.yaml:6:7: entry 'bridge.topics[1]': output 'a' is another topic's"));
}

}  // namespace
}  // namespace limb_ring::config
