#include "config/ring_sections.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <set>

#include "config/ring_config.h"
#include "config/urdf_limits.h"

namespace limb_ring::config {
namespace {

const char* const kAllowedNodes = "a list of 2 to 255 nodes, in ring order";

void read_into_roster(const Entry& item) {
  const Option<NodeConfig>& id_option = node_section()[0];
  const Option<NodeConfig>& name_option = node_section()[1];
  const auto id = item.find("id"), name = item.find("name");
  if (!id) return check_names(item, names_of(node_section()), {"id"});
  auto& nodes = item.document().nodes;
  NodeConfig node;
  id_option.read(*id, node);
  node.name = "node" + std::to_string(node.id);
  if (name) name_option.read(*name, node);
  Problems problems;
  const bool is_new = nodes.emplace(std::to_string(node.id), node.id).second;
  if (!is_new) problems.gather([&] { id->refuse_value("is the id of another node", "ids 0 to 254, each once"); });
  if (!nodes.emplace(node.name, node.id).second && (name || is_new))
    (name ? *name : item).note(problems, "'" + node.name + "' is the name of another node", "each name once");
  problems.refuse_all();
}

/// Ids and names of all nodes, before anything that may refer to them is read.
void read_roster(const std::vector<Entry>& items) {
  Problems problems;
  for (const Entry& item : items) problems.gather([&] { read_into_roster(item); });
  problems.refuse_all();
}

/// Joints and sensors of all nodes, as they stand there.
void check_part_names(const std::vector<Entry>& nodes) {
  Problems problems;
  for (const char* list : {"joints", "sensors"}) {
    std::set<std::string> names;
    for (const Entry& node : nodes) {
      const auto parts = node.is_map() ? node.find(list) : std::nullopt;
      if (!parts || !parts->is_list()) continue;
      for (const Entry& part : parts->items("")) {
        const auto name = part.is_map() ? part.find("name") : std::nullopt;
        if (name && name->is_scalar() && !names.insert(name->text("")).second)
          part.note(problems, "'" + name->text("") + "' is the name of another one", "each name once in a ring");
      }
    }
  }
  problems.refuse_all();
}

NodeConfig read_node_map(const Entry& item, const LinkConfig& links, const std::vector<HostConfig>& hosts) {
  NodeConfig node;
  node.link = links;
  node.link.port = 0;
  read_section(item, node_section(), node);
  if (node.name.empty()) node.name = "node" + std::to_string(node.id);
  const auto link = item.find("link");
  const bool own_address = link && link->find("address");
  if (!hosts.empty() && !own_address) node.link.address = hosts[node.host].address;
  if (node.link.port == 0) node.link.port = static_cast<std::uint16_t>(links.port + node.id);
  return node;
}

void read_nodes(const Entry& entry, RingConfig& ring) {
  entry.document().nodes_unsure = true;
  const std::vector<Entry> items = entry.items(kAllowedNodes, kMostNodes);
  if (items.size() < kFewestNodes)
    entry.refuse("a list of " + std::to_string(items.size()) + " is too short", kAllowedNodes);
  if (ring.links.port == 0) ring.links.port = default_first_port(ring.ring);
  Problems problems;
  entry.document().nodes_unsure = !problems.gather([&] { read_roster(items); });
  problems.gather([&] { check_part_names(items); });
  for (const Entry& item : items)
    problems.gather([&] { ring.nodes.push_back(read_node_map(item, ring.links, ring.hosts)); });
  problems.refuse_all();
}

/// Until 0.1.0 one entry stood for three waits.
void read_timeouts(const Entry& entry, RingConfig& ring) {
  if (entry.is_map())
    if (const auto bypass = entry.find("bypass"))
      bypass->refuse("has been replaced by three entries", "first_successor, break_grace, fold_permission");
  read_section(entry, timeouts_section(), ring.timeouts);
}

}  // namespace

// Read in this order: nodes take their links from `links`, and their joints' limits from `urdf`, and name their host;
// the supervisor, the bridge's topics and the traffic name nodes.
const Section<RingConfig>& ring_section() {
  static const Section<RingConfig> section{
      name_option("ring", &RingConfig::ring, is_ring_name, kRingNameRule, kRequired,
                  "Name of the ring. Programs find the ring by it."),
      choice_option("redundancy", &RingConfig::redundancy, {"none", "foldback"},
                    "foldback: a second, counter-rotating line closes the ring again around a break. With udp a node "
                    "listens for it at its port + 256."),
      section_option("limits", &RingConfig::limits, limits_section(), "Sizes of the queues."),
      {"timeouts", "{}", "a map, see below", "Waits and periods.", read_timeouts},
      section_option("links", &RingConfig::links, links_section(), "Defaults for the links of all nodes."),
      section_option("firmware", &RingConfig::firmware, firmware_section(),
                     "The program limb_firmware and its simulated servos."),
      section_option("realtime", &RingConfig::realtime, realtime_section(),
                     "What the daemons ask of the kernel. If it refuses, they say so and go on."),
      {"urdf", "none", "a path, from the folder of this file, or absolute, or package://PACKAGE/PATH",
       "A URDF. It gives the joints, by their names, their `type` and limits (`lower`, `upper`, `velocity`, "
       "`effort`). A limit in this file overrides it. A velocity or an effort that is 0 or missing in the URDF is "
       "unknown: the joint gets the default, and one warning names all such joints. A continuous joint, as of a "
       "wheel, needs no limits; limb_firmware stops it at 2147 rad. A mimic joint has no motor and belongs to no "
       "node: joint_states shows it following its joint.",
       [](const Entry& entry, RingConfig&) { read_urdf(entry); }},
      hosts_option(),
      section_option("recorder", &RingConfig::recorder, recorder_section(),
                     "Each node records what goes into its network controller and what comes out, for `ringctl "
                     "record check`."),
      {"nodes", kRequired, "a list of 2 to 255 maps, see below",
       "The nodes in ring order. Each sends to the next, and the last to the first.", read_nodes},
      section_option("supervisor", &RingConfig::supervisor, supervisor_section(),
                     "Which node watches the CPUs that have an `alive_period`, and what it does if one hangs."),
      section_option("virtual", &RingConfig::virtual_clock, virtual_clock_section(),
                     "The ring on a virtual clock (ringctl up --clock virtual)."),
      section_option("bridge", &RingConfig::bridge, bridge_section(), "The ROS side of the ring."),
      traffic_option(),
  };
  return section;
}

using namespace std::chrono_literals;

namespace {

constexpr std::size_t kMostJoints = 32, kMostSensors = 16;

const char* const kAllowedCpus = "none, attached or {command: [PROGRAM, ARGUMENT, ...]}";

/// `{command: [...]}` or `{attached: true}`, one of them.
void read_cpu_map(const Entry& entry, CpuConfig& cpu) {
  read_section(entry, cpu_section(), cpu);
  const bool attached = cpu.kind == CpuConfig::Kind::attached;
  if (attached && !cpu.command.empty()) entry.refuse("command and attached are both given", "one of them");
  if (!attached && cpu.command.empty())
    entry.refuse("'command' is missing", "a map of " + join(names_of(cpu_section())));
  if (!attached) cpu.kind = CpuConfig::Kind::child;
}

void read_cpu(const Entry& entry, NodeConfig& node) {
  if (entry.is_map()) return read_cpu_map(entry, node.cpu);
  const std::string word = entry.text(kAllowedCpus);
  if (word != "none" && word != "attached") entry.refuse_value("is unknown", kAllowedCpus);
  node.cpu.kind = word == "none" ? CpuConfig::Kind::none : CpuConfig::Kind::attached;
}

const char* unit_of(const JointConfig& joint) { return joint.slides() ? " m" : " rad"; }

/// If the ring's file does not say where it starts, it starts as near to 0 as it may.
void complete_joint(const Entry& entry, JointConfig& joint) {
  if (entry.document().urdf_unsure) return;
  Problems problems;
  for (const char* limit : {"lower", "upper", "velocity", "effort"})
    problems.gather([&] { check_urdf_limit(entry, joint, limit); });
  problems.refuse_all();
  const std::string range = format_real(joint.lower) + " to " + format_real(joint.upper) + unit_of(joint);
  const bool own = entry.document().urdf.path.empty() || entry.find("lower") || entry.find("upper");
  if (joint.lower > joint.upper || (joint.lower == joint.upper && own))
    entry.refuse("joint '" + joint.name + "' has the limits " + range, "lower less than upper");
  if (!entry.find("initial")) joint.initial = std::clamp(0.0, joint.lower, joint.upper);
  if (joint.initial < joint.lower || joint.initial > joint.upper)
    entry.refuse("joint '" + joint.name + "' has initial " + format_real(joint.initial) + ", outside its limits",
                 range);
}

void complete_sensor(const Entry& entry, SensorConfig& sensor) {
  if (!sensor.csv.empty() && !sensor.topic.empty())
    entry.refuse("sensor '" + sensor.name + "' has a csv and a topic", "one of them");
  if (sensor.topic == "sensors/" + sensor.name)
    entry.find("topic")->refuse("'" + sensor.topic + "' is where the readings of this sensor are published",
                                "the topic of whoever measures, such as imu/data");
}

/// @return absolute; refused if there is no such file
std::string read_file_beside(const Entry& entry, const char* rule) {
  const auto folder = std::filesystem::absolute(entry.document().name).parent_path();
  const std::string path = (folder / entry.text(rule)).lexically_normal().string();
  if (std::error_code error; !std::filesystem::is_regular_file(path, error))
    entry.refuse("there is no file " + path, rule);
  return path;
}

constexpr const char* kFileRule = "a path, from the folder of this file, or absolute";

Option<SensorConfig> csv_option() {
  return {"csv", "computed from the node's joints", kFileRule,
          "limb_firmware plays this recording and starts again after the last row. A row is the time in s, three "
          "linear and three angular values (m/s^2 and rad/s, or N and N m), separated by commas.",
          [](const Entry& entry, SensorConfig& sensor) { sensor.csv = read_file_beside(entry, kFileRule); }};
}

Option<SensorConfig> sensor_topic_option() {
  auto option = name_option("topic", &SensorConfig::topic, is_topic_name, kTopicNameRule, "none",
                            "The sensor's values come from this ROS topic: sensor_msgs/Imu, or "
                            "geometry_msgs/WrenchStamped for force. The bridge of the body sends each to this node, at "
                            "most `rate` a second, and limb_firmware sends it on as a reading at once. Both packets "
                            "load the ring. A topic that says nothing makes a silent sensor.");
  return option;
}

Option<NodeConfig> id_option() {
  Option<NodeConfig> id =
      integer_option("id", &NodeConfig::id, {0, 254}, "Source and destination id of the node. Each node has its own.");
  id.fallback = kRequired;
  return id;
}

/// The defaults of the joint's other entries depend on it.
Option<JointConfig> joint_type_option() {
  auto option = choice_option(
      "type", &JointConfig::type, {"revolute", "continuous", "prismatic"},
      "revolute turns, and continuous turns without end: in rad, rad/s and N m. prismatic slides: "
      "in m, m/s and N, by default from -1 to 1 m, at 1 m/s, with 500 N. With a `urdf`, the URDF gives it.");
  option.read = [read = option.read](const Entry& entry, JointConfig& joint) {
    const auto there = joint.type;
    read(entry, joint);
    if (entry.document().urdf.path.empty()) return take_usual_limits(joint);
    if (joint.type != there)
      entry.refuse_value("is another type than in " + entry.document().urdf.path, "to leave it out");
  };
  return option;
}

/// With the name it is known what a URDF says of it, as the defaults of the joint's other entries.
Option<JointConfig> joint_name_option() {
  auto option = name_option("name", &JointConfig::name, is_joint_name, kJointNameRule, kRequired,
                            "The name in JointState messages and in the `urdf`. Each name once in a ring.");
  option.read = [read_name = option.read](const Entry& entry, JointConfig& joint) {
    read_name(entry, joint);
    take_urdf_limits(entry, joint);
  };
  return option;
}

}  // namespace

const Section<NodeConfig>& node_section() {
  static const Section<NodeConfig> section{
      id_option(),
      name_option("name", &NodeConfig::name, is_node_name, kNodeNameRule, "`node` and the id",
                  "Name of the node. Each node has its own."),
      {"host", "the first of `hosts`", "name of a host", "The machine that runs the node.",
       [](const Entry& entry, NodeConfig& node) { node.host = read_host(entry); }},
      choice_option(
          "controller", &NodeConfig::controller, {"ringd", "foreign"},
          "foreign: a network controller that is not ringd, such as a board. `ringctl up` starts only the other nodes; "
          "`ringctl wait up` also waits for this one. The links on both sides of it have to be udp or unix."),
      {"library", "none", kFileRule,
       "Of a foreign node on a virtual ring: its code, a shared library with three functions, as `ringctl conform "
       "--library` takes it. Without one, a node of limb_ring stands in for it there.",
       [](const Entry& entry, NodeConfig& node) { node.library = read_file_beside(entry, kFileRule); }},
      {"cpu", "none", kAllowedCpus,
       "none: packets are counted and thrown away. attached: a program connects by itself, such as "
       "ring_bridge. command: ringd starts the program.",
       read_cpu},
      list_option("joints", &NodeConfig::joints, joint_section(), kMostJoints, complete_joint,
                  "The joints that this node drives. They need a cpu."),
      list_option(
          "sensors", &NodeConfig::sensors, sensor_section(), kMostSensors, complete_sensor,
          "The sensors that this node reads. They need a cpu. A sensor's name is the frame_id of its messages."),
      {"pins", "{0: reset, 1: stop, 2: sync}", "a map, see below", "What interrupts from the ring do at this node.",
       [](const Entry& entry, NodeConfig& node) { read_section(entry, pins_section(), node); }},
      {"inputs", "{}", "a map, see below", "Where interrupt inputs lead (a button, a watchdog, a tool).",
       [](const Entry& entry, NodeConfig& node) { read_section(entry, inputs_section(), node); }},
      {"receive_buffers", "as in `limits`", allowed(kReceiveBuffers),
       "How many packets may wait for this node's CPU, per priority. Give more to a node that many send to.",
       [](const Entry& entry, NodeConfig& node) {
         node.receive_buffers = static_cast<unsigned>(read_integer(entry, kReceiveBuffers));
       }},
      section_option("link", &NodeConfig::link, link_section(),
                     "The link into this node, from its upstream neighbour."),
  };
  return section;
}

const Section<CpuConfig>& cpu_section() {
  static const Section<CpuConfig> section{
      {"command", "required, or `attached: true`", kAllowedCommands,
       "The program is looked for beside ringd, then on PATH. A relative path with a '/' starts at the folder in which "
       "the ring is started (by roslaunch: `~/.ros`). [rosrun, PACKAGE, PROGRAM] is the program of a ROS package. The "
       "program is killed when ringd ends.",
       [](const Entry& entry, CpuConfig& cpu) { cpu.command = read_command(entry); }},
      {"attached", "false", "true, false", "Instead of `command`: the same as `cpu: attached`.",
       [](const Entry& entry, CpuConfig& cpu) {
         if (read_flag(entry)) cpu.kind = CpuConfig::Kind::attached;
       }},
      flag_option("restart_on_exit", &CpuConfig::restart_on_exit, "Start the program again when it ends by itself."),
      time_option("alive_period", &CpuConfig::alive_period, 0ms, 60s,
                  "The CPU talks to ringd at least this often, as limb_firmware does. It is hung when it has been "
                  "silent for three of these periods, or three of the period that it promised itself if that is "
                  "longer. 0s: the supervisor does not watch it."),
      time_option("turnaround", &CpuConfig::turnaround, 0ns, 1s,
                  "On a virtual ring: what the CPU sends in a turn enters the node this long after the turn began."),
      time_option(
          "jitter", &CpuConfig::jitter, 0ns, 1s,
          "On a virtual ring: added to `turnaround`, up to this much, drawn for each turn by `virtual: {seed}`."),
  };
  return section;
}

const Section<JointConfig>& joint_section() {
  Option<JointConfig> initial =
      real_option("initial", &JointConfig::initial, kPositions, "Position when the firmware starts.");
  initial.fallback = "the position nearest to 0 within the limits";
  static const Section<JointConfig> section{
      joint_name_option(),
      joint_type_option(),
      real_option("lower", &JointConfig::lower, kPositions, "Lower limit of the position."),
      real_option("upper", &JointConfig::upper, kPositions, "Upper limit of the position."),
      real_option("velocity", &JointConfig::velocity, kVelocities, "Limit of the speed, both ways."),
      real_option("effort", &JointConfig::effort, kEfforts, "Limit of the torque or force, both ways."),
      initial,
      choice_option("safe", &JointConfig::safe, {"hold", "damp"},
                    "Safe state: hold the position, or no torque and only damping."),
  };
  return section;
}

const Section<SensorConfig>& sensor_section() {
  static const Section<SensorConfig> section{
      name_option("name", &SensorConfig::name, is_sensor_name, kSensorNameRule, kRequired,
                  "The topic is sensors/NAME. Each name once in a ring."),
      choice_option("kind", &SensorConfig::kind, {"imu", "force"},
                    "imu: acceleration and turn rate. force: force and torque."),
      real_option("rate", &SensorConfig::rate, {0.1, 1000, "Hz"}, "How often a reading is sent."),
      integer_option("priority", &SensorConfig::priority, {0, 3}, "Priority of its packets; 0 is the highest."),
      csv_option(),
      sensor_topic_option(),
  };
  return section;
}

namespace {

using Action = PinConfig::Action;

const char* const kAllowedPins = "none, reset, stop, notify, sync, {signal: NAME} or {exec: [PROGRAM, ARGUMENT, ...]}";

struct Signal {
  const char* name;
  int number;
};
constexpr std::array<Signal, 10> kSignals{{{"HUP", SIGHUP},
                                           {"INT", SIGINT},
                                           {"QUIT", SIGQUIT},
                                           {"USR1", SIGUSR1},
                                           {"USR2", SIGUSR2},
                                           {"ALRM", SIGALRM},
                                           {"TERM", SIGTERM},
                                           {"CONT", SIGCONT},
                                           {"STOP", SIGSTOP},
                                           {"KILL", SIGKILL}}};

int read_signal(const Entry& entry) {
  std::vector<std::string> names;
  for (const Signal& signal : kSignals) names.emplace_back(signal.name);
  return kSignals[read_choice(entry, names)].number;
}

/// `{signal: USR1}` or `{exec: [...]}`, one of them.
PinConfig read_pin_map(const Entry& entry) {
  check_names(entry, {"signal", "exec"}, {});
  const auto signal = entry.find("signal"), exec = entry.find("exec");
  if (signal.has_value() == exec.has_value())
    entry.refuse(signal ? "signal and exec are both given" : "the map is empty", kAllowedPins);
  PinConfig pin;
  pin.action = signal ? Action::signal : Action::exec;
  if (signal) pin.signal = read_signal(*signal);
  if (exec) pin.command = read_command(*exec);
  return pin;
}

PinConfig read_pin(const Entry& entry) {
  if (entry.is_map()) return read_pin_map(entry);
  constexpr std::array<Action, 5> actions{Action::none, Action::reset, Action::stop, Action::notify, Action::sync};
  const std::string text = entry.text(kAllowedPins);
  if (text == "signal" || text == "exec") entry.refuse_value("needs a value", kAllowedPins);
  PinConfig pin;
  pin.action = actions[read_choice(entry, {"none", "reset", "stop", "notify", "sync"})];
  return pin;
}

const char* default_pin(std::size_t factor) {
  constexpr std::array<const char*, 3> wired{"reset", "stop", "sync"};
  return factor < wired.size() ? wired[factor] : "none";
}

InputConfig read_input(const Entry& entry) {
  InputConfig input;
  read_section(entry, input_section(), input);
  return input;
}

void read_input_target(const Entry& entry, InputConfig& input) {
  input.broadcast = entry.is_scalar() && entry.text("") == "all";
  if (!input.broadcast) input.node = read_node(entry, ", or all");
}

Section<NodeConfig> make_pins() {
  Section<NodeConfig> section;
  for (std::size_t factor = 0; factor < kPins; ++factor)
    section.push_back({std::to_string(factor), default_pin(factor), kAllowedPins,
                       "What INT" + std::to_string(factor) + " from the ring does at this node.",
                       [factor](const Entry& entry, NodeConfig& node) { node.pins[factor] = read_pin(entry); }});
  return section;
}

Section<NodeConfig> make_inputs() {
  Section<NodeConfig> section;
  for (std::size_t input = 0; input < kPins; ++input)
    section.push_back({std::to_string(input), "wired to nothing", "a map, see below",
                       "Where interrupt input " + std::to_string(input) + " leads.",
                       [input](const Entry& entry, NodeConfig& node) { node.inputs[input] = read_input(entry); }});
  return section;
}

}  // namespace

const Section<NodeConfig>& pins_section() {
  static const Section<NodeConfig> section = make_pins();
  return section;
}

const Section<NodeConfig>& inputs_section() {
  static const Section<NodeConfig> section = make_inputs();
  return section;
}

const Section<InputConfig>& input_section() {
  static const Section<InputConfig> section = [] {
    Option<InputConfig> factor = integer_option("factor", &InputConfig::factor, {0, 7},
                                                "The pin that is pulled there. A broadcast must not reset all nodes.");
    factor.fallback = kRequired;
    return Section<InputConfig>{
        {"to", kRequired, "id or name of a node, or all", "The destination of the INTP.", read_input_target}, factor};
  }();
  return section;
}

}  // namespace limb_ring::config
