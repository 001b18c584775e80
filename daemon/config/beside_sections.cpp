#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "config/entry.h"
#include "config/ring_config.h"
#include "config/ring_sections.h"

namespace limb_ring::config {
namespace {

const std::vector<std::string> kSaveWords{"crash", "break", "promise"};
constexpr const char* kSaveRule = "a list of crash, break, promise";
constexpr const char* kFolderRule = "a path, from the folder of this file, or absolute";

void read_save(const Entry& entry, RecorderSaves& saves) {
  saves.when.clear();
  for (const Entry& item : entry.items(kSaveRule, kSaveWords.size()))
    saves.when.push_back(kSaveWords[read_choice(item, kSaveWords)]);
}

const Section<RecorderSaves>& saves_section() {
  static const Section<RecorderSaves> section{
      {"save", "[]", kSaveRule,
       "When `ringctl up` saves the recordings of all nodes. crash: a daemon has crashed. break: a broken line was "
       "located. promise: the ring has broken a promise; `ringctl up` then judges as `ringctl traffic judge` does.",
       read_save},
      {"folder", "`~/.local/state/limb_ring`", kFolderRule,
       "Where the saves go. Each is a folder named by ring, date and reason. If XDG_STATE_HOME is set, the default is "
       "$XDG_STATE_HOME/limb_ring.",
       [](const Entry& entry, RecorderSaves& saves) { saves.folder = entry.text(kFolderRule); }},
      integer_option("keep", &RecorderSaves::keep, {1, 1000}, "How many saves of the ring are kept, the newest."),
  };
  return section;
}

std::string usual_folder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state == '/') return std::string(state) + "/limb_ring";
  const char* home = std::getenv("HOME");
  return std::string(home != nullptr ? home : "/tmp") + "/.local/state/limb_ring";
}

}  // namespace

// The options of saving are only checked here; `ringctl up`, which saves, reads them (ring_config.h).
const Section<RecorderConfig>& recorder_section() {
  static const Section<RecorderConfig> section = [] {
    Section<RecorderConfig> all{
        flag_option("enabled", &RecorderConfig::enabled, "Record on a live ring, as `ringctl up --record` does."),
        integer_option("size", &RecorderConfig::size, {1u << 20, 1u << 30},
                       "Bytes of each node's file in the ring's folder. The oldest records are overwritten."),
    };
    for (const Option<RecorderSaves>& option : saves_section())
      all.push_back({option.name, option.fallback, option.allowed, option.meaning,
                     [read = option.read](const Entry& entry, RecorderConfig&) {
                       RecorderSaves checked;
                       read(entry, checked);
                     }});
    return all;
  }();
  return section;
}

RecorderSaves load_recorder_saves(const std::string& path, bool records) {
  Document document;
  document.name = path;
  const Entry file(parse_yaml(read_file(path), path), "", document);
  RecorderSaves saves;
  if (const auto recorder = file.find("recorder")) {
    for (const Option<RecorderSaves>& option : saves_section())
      if (const auto entry = recorder->find(option.name)) option.read(*entry, saves);
    if (!saves.when.empty() && !records)
      recorder->find("save")->refuse("nothing is recorded, so nothing can be saved",
                                     "save only with enabled: true, or 'ringctl up --record'");
  }
  const auto beside = std::filesystem::absolute(path).parent_path();
  saves.folder = saves.folder.empty() ? usual_folder() : (beside / saves.folder).lexically_normal().string();
  return saves;
}

namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMostTopics = 255;
constexpr std::size_t kMostControllers = 16;
constexpr TimeRange kBridgePhases{0s, 1s, nanoseconds(1)};
constexpr const char* kControllers = "true (joint_commands), false, or a list of up to 16 topics of joint commands";

void check_topic(const Entry& entry, TopicConfig& topic) {
  if (topic.from == topic.to) entry.refuse("the topic goes from a node to itself", "two nodes, each with a bridge");
  if ((topic.size == 0) != (topic.rate == 0))
    entry.refuse(topic.size == 0 ? "the topic has a rate and no size" : "the topic has a size and no rate",
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
  return {
      "lockstep", "false", kControllers,
      "On a virtual ring: after each joint_states the ring's time stands until each of these topics has answered with "
      "joint commands of that stamp or a later one, for at most `virtual: {stall}` of real time.",
      [](const Entry& entry, BridgeConfig& bridge) { bridge.lockstep = read_controllers(entry); }};
}

Option<BridgeConfig> bridge_phase_option() {
  return {
      "phase", "none", allowed(kBridgePhases),
      "joint_states is sent this long after each multiple of its period on the clock. limb_firmware samples at the "
      "multiples, so if the phase is long enough, each message has the samples of its own period. none: periods count "
      "from the start of the bridge.",
      [](const Entry& entry, BridgeConfig& bridge) { bridge.phase = read_time(entry, kBridgePhases); }};
}

}  // namespace

const Section<BridgeConfig>& bridge_section() {
  static const Section<BridgeConfig> section{
      real_option("rate", &BridgeConfig::rate, {1, 1000, "Hz"}, "How often joint_states is sent."),
      bridge_phase_option(),
      flag_option(
          "broadcast_commands", &BridgeConfig::broadcast_commands,
          "joint_commands for several nodes cross the ring as one broadcast, not as a packet to each. This allows up "
          "to 1 kHz, because a node has only one packet under way at a time. The CPUs have to know command sets, as "
          "limb_firmware and JointNode do."),
      list_option("topics", &BridgeConfig::topics, topic_section(), kMostTopics, check_topic,
                  "ROS topics that cross the ring unmodified, from one bridge to another."),
      controllers_option(),
  };
  return section;
}

const Section<TopicConfig>& topic_section() {
  static const Section<TopicConfig> section{
      name_option("input", &TopicConfig::input, is_topic_name, kTopicNameRule, kRequired,
                  "The topic that the bridge of `from` subscribes to."),
      name_option("output", &TopicConfig::output, is_topic_name, kTopicNameRule, "as `input`",
                  "The topic that the bridge of `to` publishes."),
      node_option("from", &TopicConfig::from, "The node whose bridge subscribes to it. Not one with cpu: none."),
      node_option("to", &TopicConfig::to, "The node whose bridge publishes it. Not one with cpu: none."),
      integer_option("priority", &TopicConfig::priority, {0, 3},
                     "Priority of its packets; 0 is the highest. Joint data has 0."),
      integer_option("queue", &TopicConfig::queue, {1, 1000},
                     "How many messages may wait to be sent. Then the oldest is dropped and counted."),
      integer_option("size", &TopicConfig::size, {0, kLargestMessage},
                     "Only for `ring_sim plan`: bytes of a message. 0: not planned."),
      real_option("rate", &TopicConfig::rate, {0, 100000, "Hz"},
                  "Only for `ring_sim plan`: messages a second. 0: not planned."),
      deadline_option<TopicConfig>(),
  };
  return section;
}

const Section<SupervisorConfig>& supervisor_section() {
  static const Section<SupervisorConfig> section{
      {"node", "the first whose cpu is attached, else the first", "id or name of a node",
       "The node that watches, by the beacons of the others and the signs of life of its own CPU.",
       [](const Entry& entry, SupervisorConfig& supervisor) { supervisor.node = read_node(entry); }},
      choice_option("policy", &SupervisorConfig::policy, {"off", "report", "auto"},
                    "off: nothing is watched. report: a hung CPU is logged and shown. auto: it is also reset."),
      time_option("grace", &SupervisorConfig::grace, 10ms, 600s,
                  "A CPU is not judged for this time after its start. A reset that is not confirmed within this time "
                  "has failed."),
      integer_option("tries", &SupervisorConfig::tries, {1, 10}, "auto: resets in a row before a CPU is given up."),
      time_option(
          "backoff", &SupervisorConfig::backoff, 10ms, 600s,
          "auto: wait from one reset of a CPU to the next. The wait doubles each time, until the CPU has run for "
          "`grace` and this wait."),
  };
  return section;
}

const Section<VirtualClockConfig>& virtual_clock_section() {
  static const Section<VirtualClockConfig> section{
      time_option("boot_time", &VirtualClockConfig::boot_time, 0ms, 60s,
                  "From a CPU's start to its first turn, by the ring's clock, however long the start really takes."),
      time_option("stall", &VirtualClockConfig::stall, 10ms, 600s,
                  "Real time. A CPU that takes longer over its turn is stuck, and the ring goes on without it."),
      integer_option("seed", &VirtualClockConfig::seed, {0, 1000000}, "Seed of the CPUs' jitter."),
      integer_option("order", &VirtualClockConfig::order, {0, 1000000},
                     "Seed of the order in which CPUs act in one instant, one after the other. 0: side by side."),
  };
  return section;
}

}  // namespace limb_ring::config
