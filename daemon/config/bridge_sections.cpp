#include "config/sections.h"

namespace limb_ring::config {
namespace {

constexpr std::size_t kMostTopics = 255;

void check_topic(const Entry& entry, const TopicConfig& topic) {
  if (topic.from == topic.to) entry.refuse("the topic goes from a node to itself", "two nodes, each with a bridge");
  if ((topic.size == 0) != (topic.rate == 0))
    entry.refuse(topic.size == 0 ? "it has a rate and no size" : "it has a size and no rate",
                 "size and rate, or neither of them");
}

}  // namespace

const Section<BridgeConfig>& bridge_section() {
  static const Section<BridgeConfig> section{
      real_option("rate", &BridgeConfig::rate, {1, 1000, "Hz"}, "How often joint_states is sent."),
      list_option("topics", &BridgeConfig::topics, topic_section(), kMostTopics, check_topic,
                  "ROS topics that cross the ring unmodified, from one bridge to another."),
      flag_option(
          "lockstep", &BridgeConfig::lockstep,
          "On a virtual ring: after joint_states its time stands until joint_commands of that stamp or a later one "
          "have come, for `virtual: {stall}` of real time at most."),
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
  };
  return section;
}

}  // namespace limb_ring::config
