#include <algorithm>

#include "config/sections.h"

namespace limb_ring::config {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMostTopics = 255;
constexpr std::size_t kMostControllers = 16;
constexpr TimeRange kBridgePhases{0s, 1s, nanoseconds(1)};
constexpr const char* kControllers = "true (joint_commands), false, or a list of up to 16 topics of joint commands";

void check_topic(const Entry& entry, TopicConfig& topic) {
  if (topic.from == topic.to) entry.refuse("the topic goes from a node to itself", "two nodes, each with a bridge");
  if ((topic.size == 0) != (topic.rate == 0))
    entry.refuse(topic.size == 0 ? "it has a rate and no size" : "it has a size and no rate",
                 "size and rate, or neither of them");
}

std::vector<std::string> read_controllers(const Entry& entry) {
  if (entry.is_scalar()) {
    const std::string text = entry.text(kControllers);
    if (text != "true" && text != "false") entry.refuse_value("is unknown", kControllers);
    return text == "true" ? std::vector<std::string>{"joint_commands"} : std::vector<std::string>{};
  }
  std::vector<std::string> topics;
  for (const Entry& item : entry.items(kControllers, kMostControllers)) {
    topics.push_back(read_name(item, is_topic_name, kTopicNameRule));
    if (std::count(topics.begin(), topics.end(), topics.back()) != 1)
      item.refuse_value("is listed twice", "each topic once");
  }
  return topics;
}

Option<BridgeConfig> controllers_option() {
  return {"lockstep", "false", kControllers,
          "On a virtual ring: after joint_states its time stands until an answer, joint commands of that stamp or a "
          "later one, has come on each topic, for `virtual: {stall}` of real time at most.",
          [](const Entry& entry, BridgeConfig& bridge) { bridge.lockstep = read_controllers(entry); }};
}

Option<BridgeConfig> bridge_phase_option() {
  return {
      "phase", "none", allowed(kBridgePhases),
      "joint_states go out so long after each multiple of their period on the clock. limb_firmware samples at the "
      "multiples, so with enough of it each message holds the samples of its own period. none: periods count from the "
      "bridge's start.",
      [](const Entry& entry, BridgeConfig& bridge) { bridge.phase = read_time(entry, kBridgePhases); }};
}

}  // namespace

const Section<BridgeConfig>& bridge_section() {
  static const Section<BridgeConfig> section{
      real_option("rate", &BridgeConfig::rate, {1, 1000, "Hz"}, "How often joint_states is sent."),
      bridge_phase_option(),
      flag_option(
          "broadcast_commands", &BridgeConfig::broadcast_commands,
          "joint_commands for several nodes cross the ring in one broadcast rather than in a packet to each, so at "
          "rates up to 1 kHz: a node has one packet under way at a time. The CPUs have to know command sets, as "
          "limb_firmware does."),
      list_option("topics", &BridgeConfig::topics, topic_section(), kMostTopics, check_topic,
                  "ROS topics that cross the ring unmodified, from one bridge to another."),
      controllers_option(),
  };
  return section;
}

const Section<TopicConfig>& topic_section() {
  static const Section<TopicConfig> section{
      name_option("input", &TopicConfig::input, is_topic_name, kTopicNameRule, kRequired,
                  "The topic subscribed at `from`."),
      name_option("output", &TopicConfig::output, is_topic_name, kTopicNameRule, "as `input`",
                  "The topic advertised at `to`."),
      node_option("from", &TopicConfig::from, "The node whose bridge hears it. Not cpu: none."),
      node_option("to", &TopicConfig::to, "The node whose bridge says it again. Not cpu: none."),
      integer_option("priority", &TopicConfig::priority, {0, 3}, "Of its packets; 0 is the highest. Joint data has 0."),
      integer_option("queue", &TopicConfig::queue, {1, 1000},
                     "Messages waiting to be sent; the oldest is dropped, counted."),
      integer_option("size", &TopicConfig::size, {0, kLargestMessage},
                     "For `ring_sim plan` alone: bytes of a message. 0: not planned."),
      real_option("rate", &TopicConfig::rate, {0, 100000, "Hz"},
                  "For `ring_sim plan` alone: messages a second. 0: not planned."),
      deadline_option<TopicConfig>(),
  };
  return section;
}

}  // namespace limb_ring::config
