#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/quantity.h"
#include "limb_ring/payload/sensor_reading.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::config {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

/// What an interrupt pin drives (ours). Factors 0, 1, 2 default to reset, stop, sync.
struct PinConfig {
  enum class Action { none, reset, stop, signal, notify, sync, exec } action = Action::none;
  int signal = 0;                    ///< Action::signal: its number
  std::vector<std::string> command;  ///< Action::exec: program and arguments
};

/// As a ring's file calls it: "reset".
const char* name_of(PinConfig::Action action);

constexpr std::size_t kPins = 8;  ///< of a node, for INT0 to INT7; and as many interrupt inputs (paper)
using Pins = std::array<PinConfig, kPins>;
/// INT0 reset, INT1 stop, INT2 sync, the rest none.
Pins default_pins();

/// Where an interrupt input of the NC leads: pulling it sends INTP `factor` to `node`. (paper)
struct InputConfig {
  bool broadcast = false;
  std::uint8_t node = 0;
  std::uint8_t factor = 0;
};

/// The CPU of a node, and where its process comes from.
struct CpuConfig {
  /// none: a built-in sink reads and counts. child: ringd starts `command`. attached: an outside
  /// process (ring_bridge) connects; until it has, packets are refused.
  enum class Kind { none, child, attached } kind = Kind::none;
  std::vector<std::string> command;  ///< program (looked for beside ringd, then on PATH), arguments
  bool restart_on_exit = true;       ///< child: start it again when it ends by itself
  /// A CPU that is silent for this many alive periods counts as hung. (ours)
  static constexpr int kSilentPeriods = 3;
  milliseconds alive_period{0};  ///< it says something at least so often; 0: it is not watched
  nanoseconds turnaround{0};     ///< on a virtual ring: from a turn to what it sends in it
  nanoseconds jitter{0};         ///< ... and up to so much more, drawn for each turn
};

/// Units are rad, rad/s and N m if it turns, m, m/s and N if it slides.
struct JointConfig {
  std::string name;
  /// revolute and continuous turn, the latter without end; prismatic slides.
  enum class Type { revolute, continuous, prismatic } type = Type::revolute;
  double lower = -3.14, upper = 3.14;  ///< position
  double velocity = 6.0;               ///< limit, both ways
  double effort = 50.0;                ///< limit, both ways
  double initial = 0.0;                ///< position
  enum class Safe { hold, damp } safe = Safe::hold;
  bool slides() const { return type == Type::prismatic; }
};

/// A joint without a motor, which the robot's description lets follow one of the ring: the bridge tells ROS where it
/// is, and no node knows it.
struct FollowerConfig {
  std::string name;
  std::string leader;  ///< a joint of the ring
  double multiplier = 1, offset = 0;
};

struct SensorConfig {
  std::string name;
  enum class Kind { imu, force } kind = Kind::imu;
  double rate = 100.0;        ///< Hz
  std::string csv;            ///< file that limb_firmware plays, absolute once loaded; empty: none
  std::string topic;          ///< ROS topic whose values the bridge hands to its CPU; empty: none
  std::uint8_t priority = 1;  ///< 0..3
};
/// "a reading of an IMU as sensor 2 (from 0), which the ring's file does not give it"; empty: it is of one of these.
std::string unfit(const payload::SensorReading& reading, const std::vector<SensorConfig>& sensors);

/// What a line over a real network is expected to do: for plans, a virtual ring, and the time-outs. Nothing of it is
/// added to a line of a living ring: the network does that. (ours)
struct ExpectedConfig {
  nanoseconds delay{0};  ///< one way
  double loss = 0;       ///< probability that a datagram does not arrive
};

/// The link INTO a node: how its upstream neighbour on the same host connects to it. From other hosts it is UDP, at
/// the same address and port.
struct LinkConfig {
  enum class Transport { unix_stream, shm, udp } transport = Transport::shm;
  std::string address = "127.0.0.1";  ///< udp: the node listens there, and only there
  /// udp: `links.port` + id if the node's own is not given; loading fills it in. In
  /// RingConfig::links: the port of id 0, of the ring's name if not given.
  std::uint16_t port = 0;
  /// udp: where the node listens on the second line, against the ring. (ours)
  std::uint16_t second_port() const { return static_cast<std::uint16_t>(port + 256); }
  std::uint64_t rate = 0;  ///< bit/s; 0: as fast as the host
  nanoseconds delay{0};    ///< emulated: of line and relay together
  ExpectedConfig expected;
  /// One way, all in all: what is emulated, and what the network is expected to take.
  nanoseconds whole_delay() const { return delay + expected.delay; }
  std::string key;        ///< udp: file with the ring's key, absolute once loaded; empty: not keyed
  bool insecure = false;  ///< udp beyond this host without a key is meant so
};

/// A machine that runs some of the ring's nodes. (ours)
struct HostConfig {
  std::string name;
  std::string address;  ///< IPv4 or IPv6, in numbers: the others' lines come in there
  std::string ssh;      ///< where `ringctl --ssh` goes; empty: the address
  const std::string& ssh_destination() const { return ssh.empty() ? address : ssh; }
};

/// A node, as the list `nodes` has it.
struct NodeConfig {
  std::uint8_t id = 0;
  std::string name;
  std::size_t host = 0;  ///< its place in RingConfig::hosts; 0 also if no hosts are given
  /// Whose network controller it is. foreign: somebody else's, which limb_ring does not start.
  enum class Controller { ringd, foreign } controller = Controller::ringd;
  std::string library;  ///< foreign: its code on a virtual ring, a shared library, absolute; empty: none
  CpuConfig cpu;
  std::vector<JointConfig> joints;
  std::vector<SensorConfig> sensors;
  Pins pins = default_pins();
  std::array<std::optional<InputConfig>, kPins> inputs;
  LinkConfig link;
  std::optional<unsigned> receive_buffers;  ///< default: as Limits
};

/// The bounds of a node's queues and buffers. (ours)
struct Limits {
  /// DATPs of 524 bytes that may wait in the Packet Manager, or more smaller ones; default: config/core_settings.h
  std::optional<unsigned> insertion_buffer;
  unsigned interrupt_buffer = 64;  ///< INTPs that may wait there
  unsigned send_queue = 64;        ///< per priority
  unsigned receive_buffers = 32;   ///< per priority
  unsigned clients = 32;           ///< on a host port
};

/// The waits of protocol.md section 7.4. (ours)
struct Timeouts {
  milliseconds send{100};             ///< least time-out of one try
  milliseconds refused{1000};         ///< a refused unicast is tried again for so long
  milliseconds refused_backoff{64};   ///< ceiling of the doubling wait between those tries
  milliseconds queue{5000};           ///< a send that could not go onto the line by then ends
  milliseconds stall{50};             ///< a packet in flight without a slice for so long is aborted
  milliseconds idle{50};              ///< a quiet link sends idle so often
  milliseconds silence{250};          ///< a link silent for so long counts as broken
  milliseconds first_successor{200};  ///< at start: only the configured successor is asked for so long
  milliseconds break_grace{200};      ///< an input lost for so long: a broken line
  milliseconds fold_permission{200};  ///< so long after its start a node may fold, whatever it has heard
  milliseconds beacon{100};
  milliseconds cpu_boot{5000};  ///< a child that has not connected by then counts as failed
  milliseconds command{200};    ///< a joint without a command for so long: its safe state
};

/// What is done about a hung CPU. The network controller of a hung CPU goes on relaying, and an INTP
/// to its reset pin cures it (paper); who watches and how often it is tried is ours.
struct SupervisorConfig {
  std::optional<std::uint8_t> node;  ///< none: body_of(), see supervisor_of()
  enum class Policy { off, report, automatic } policy = Policy::report;
  milliseconds grace{5000};    ///< to boot: not judged before, and a reset has failed after it
  unsigned tries = 3;          ///< resets in a row, then it is given up
  milliseconds backoff{1000};  ///< from a failed reset to the next; it doubles
};

/// What limb_firmware simulates.
struct Firmware {
  double state_rate = 100.0;  ///< Hz
  double bandwidth = 8.0;     ///< Hz, natural frequency of the simulated servo
  double damping = 0.9;       ///< its damping ratio
};

/// Bytes of the largest message: 65,535 fragments of 492 (client/fragment.h).
constexpr std::uint32_t kLargestMessage = 0xFFFF * 492;

/// A ROS topic carried over the ring from one bridge to another.
struct TopicConfig {
  std::string input;   ///< topic subscribed at the bridge of `from`
  std::string output;  ///< topic advertised at the bridge of `to`; default: as `input`
  std::uint8_t from = 0, to = 0;
  std::uint8_t priority = 3;
  unsigned queue = 4;       ///< messages waiting to be sent; the oldest is dropped, counted
  unsigned size = 0;        ///< for plans: bytes of a message; 0: not planned
  double rate = 0;          ///< for plans: Hz; 0: not planned
  nanoseconds deadline{0};  ///< for plans: a message that is delivered later is late; 0: its period
};

/// A stream that no other entry of the file describes: for plans and simulation. The daemons do not
/// read it. (ours)
struct TrafficConfig {
  std::string name;
  std::uint8_t from = 0, to = 0;
  bool broadcast = false;                 ///< to all others; `to` means nothing
  unsigned size = 0;                      ///< bytes of a message; above 512 it travels as topic fragments
  std::optional<std::uint8_t> interrupt;  ///< instead of a message an INTP with this factor
  double rate = 0;                        ///< Hz
  std::uint8_t priority = 3;
  nanoseconds deadline{0};           ///< delivered later it is late; 0: its period
  nanoseconds jitter{0};             ///< asked for up to so much later than its period says
  std::optional<nanoseconds> phase;  ///< first message so long after the start; none: by the seed
};

/// What ring_bridge does.
struct BridgeConfig {
  double rate = 50.0;  ///< Hz of joint_states
  std::optional<nanoseconds>
      phase;                        ///< joint_states so long after the multiples of its period; none: from its start on
  bool broadcast_commands = false;  ///< one packet for the commands of all nodes
  std::vector<TopicConfig> topics;
  /// On a virtual ring time waits for an answer to joint_states on each of these topics of joint commands.
  std::vector<std::string> lockstep;
};

/// Of a ring on a virtual clock (ringctl up --clock virtual).
struct VirtualClockConfig {
  milliseconds boot_time{20};  ///< from a CPU's start to its first turn, by the ring's clock
  milliseconds stall{5000};    ///< real time: who takes longer over a turn is stuck
  std::uint32_t seed = 1;      ///< of the CPUs' jitter
  std::uint32_t order = 0;     ///< seed of who acts first in one instant; 0: in the order of the nodes, side by side
};

/// The flight recorder of each node (ours).
struct RecorderConfig {
  bool enabled = false;
  unsigned size = 8u << 20;  ///< bytes of each node's file
};

/// Which cores the daemons have, and how the kernel schedules them.
struct Realtime {
  std::vector<unsigned> cores;  ///< pin the daemons there; empty: anywhere
  bool auto_cores = false;      ///< a core for each daemon, neighbours together
  int fifo = 0;                 ///< SCHED_FIFO priority 1..99; 0: off
  bool lock_memory = false;
  nanoseconds spin{0};  ///< look for packets for so long before sleeping
};

/// Nodes of a ring: one alone has nobody to send to, and of the 256 ids the last one means all nodes.
constexpr unsigned kFewestNodes = 2, kMostNodes = 255;

/// A file and what was read from it.
struct ReadFile {
  std::string path, text;
};

/// One ring, as its YAML file says. Read by every program; config/OPTIONS.md lists every entry
/// with default, range and unit.
struct RingConfig {
  std::string ring;
  std::string path;               ///< file it was read from; empty if made by plain_ring()
  std::vector<ReadFile> files;    ///< that it was read from: its own, and a URDF
  std::vector<HostConfig> hosts;  ///< in the file's order; empty: all nodes are on one machine, or nobody has said
  std::vector<NodeConfig> nodes;  ///< in ring order, which is the file's order
  /// foldback: a second, counter-rotating line closes the ring again around a break. (ours)
  enum class Redundancy { none, foldback } redundancy = Redundancy::none;
  Limits limits;
  Timeouts timeouts;
  VirtualClockConfig virtual_clock;
  LinkConfig links;  ///< what the nodes' links are where they do not say otherwise
  Firmware firmware;
  BridgeConfig bridge;
  Realtime realtime;
  RecorderConfig recorder;
  SupervisorConfig supervisor;
  std::vector<TrafficConfig> traffic;
  std::vector<FollowerConfig> followers;  ///< the `urdf`'s mimic joints whose leader is in the ring
  std::vector<std::string> warnings;      ///< what was assumed since the file does not say it, for people

  /// There is a second line.
  bool folds_back() const { return redundancy == Redundancy::foldback; }
  /// Ids of all nodes, in ring order.
  std::vector<std::uint8_t> node_ids() const;
  const NodeConfig* find(std::uint8_t id) const;
  /// By id ("12") or name ("left_knee").
  const NodeConfig* find(const std::string& id_or_name) const;
  /// Of a node; of one that is not configured, its id in digits.
  std::string name_of(std::uint8_t id) const;
  const HostConfig* find_host(const std::string& name) const;
  /// Of a node; nullptr if no hosts are given.
  const HostConfig* host_of(const NodeConfig& node) const;
};

/// How a line goes from one node to another: within a host as the second one's link says, else by UDP. (ours)
LinkConfig::Transport transport_between(const NodeConfig& from, const NodeConfig& to);

/// "unix", "shm", "udp": as a ring's file and command lines have them, in the order of LinkConfig::Transport.
const std::vector<std::string>& transport_words();
/// What a line is, in a sentence: "shared memory", "a UNIX stream", "UDP".
const char* words_of(LinkConfig::Transport transport);

/// UDP comes to this node from beyond its host, also if only a bypass would bring it.
bool hears_other_hosts(const RingConfig& ring, const NodeConfig& node);

/// The first node in ring order whose CPU is attached (the bridge's, usually the body), else the
/// first node. Limbs send their states and readings there, and get their commands from there. (ours)
/// @pre the ring has a node
const NodeConfig& body_of(const RingConfig& ring);

/// The node that watches the CPUs of the others: the one configured, else the body.
const NodeConfig& supervisor_of(const RingConfig& ring);

/// The first of a node's pins that is wired to that; nothing if none is.
std::optional<std::uint8_t> first_pin(const NodeConfig& node, PinConfig::Action action);

/// True if some node has pin `factor` wired to reset: a broadcast of it needs to be forced.
bool ring_has_reset_on(const RingConfig& ring, unsigned factor);

/// What the names in a configuration may look like (ours), each with its rule in words.
constexpr const char* kRingNameRule = "1 to 32 letters, digits, '-', '_' and '.', not beginning with '.' or '-'";
constexpr const char* kNodeNameRule = "a letter, then letters, digits and '_', 32 at most, and not the word 'all'";
constexpr const char* kHostNameRule =
    "a letter, then letters, digits, '_', '-' and '.', 64 at most, and not the word 'all'";
constexpr const char* kPartNameRule = "a letter, then letters, digits, '_', '-' and '.', 64 at most";
constexpr const char* kJointNameRule =
    "a letter, a digit, '_' or '/', then letters, digits, '_', '-', '.' and '/', 64 at most";
constexpr const char* kSensorNameRule = "a letter, then letters, digits and '_', 64 at most";
constexpr const char* kTopicNameRule =
    "a ROS topic name, not a private one: a letter or '/', then letters, digits, '_' and '/', 200 at most";

using limb_ring::is_ring_name;
bool is_node_name(const std::string& name);
/// A machine that runs nodes.
bool is_host_name(const std::string& name);
/// A stream of `traffic` or of a scenario.
bool is_part_name(const std::string& name);
/// As robot descriptions have it, with the '/' of ROS names.
bool is_joint_name(const std::string& name);
/// A sensor's name is part of its topic's, in which ROS allows neither '-' nor '.'.
bool is_sensor_name(const std::string& name);
bool is_topic_name(const std::string& name);

/// The one of `candidates` that `word` was probably meant to be; empty if none is close.
std::string closest(const std::string& word, const std::vector<std::string>& candidates);

/// "a, b, c"
std::string join(const std::vector<std::string>& words, const std::string& between = ", ");

/// A ring without a file: ids 0 to nodes-1, names node0 and so on, no CPUs, all else default.
/// @throw ConfigError if the name is not a ring name or `nodes` is not 2 to 255.
RingConfig plain_ring(const std::string& ring, unsigned nodes);

/// Makes every link of the ring `unix`, `shm` or `udp`, whatever its file says (the command line's transport).
/// @throw ConfigError for any other word, or if a line would come from beyond its host without a key
void apply_transport(RingConfig& ring, const std::string& transport);

/// All nodes are on this machine, whatever hosts the file gives: a robot's ring tried out at a desk.
void apply_one_host(RingConfig& ring);

/// Gives the ring another name (a second ring of one file on a host). UDP ports that came from the
/// old name move to the new one's.
/// @throw ConfigError if it is not a ring name.
void rename_ring(RingConfig& ring, const std::string& name);

/// Where a ring's UDP ports begin unless its file says otherwise: id 0 has this one, id n the
/// n-th after it. Of the ring's name, so that rings side by side on a host do not meet; 17000 to
/// 32104 in steps of 256, below the ports Linux gives out by itself. (ours)
std::uint16_t default_first_port(const std::string& ring);

/// When the recordings of a ring are saved by themselves: for `ringctl up`, the daemons do not need it. (ours)
struct RecorderSaves {
  std::vector<std::string> when;  ///< of "crash", "break", "promise"; empty: never
  std::string folder;             ///< absolute; each save is a folder in it
  unsigned keep = 5;              ///< so many saves of a ring, the newest
};

/// The entries `recorder.save`, `folder` and `keep` of a ring's file.
/// @param records whether its nodes record
/// @throw ConfigError, also if something is to be saved and nothing is recorded
RecorderSaves load_recorder_saves(const std::string& path, bool records);

}  // namespace limb_ring::config
