#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wire/packet.h"

// Wherever a fault is interpreted, a case that is missing is an error.
#pragma GCC diagnostic error "-Wswitch"

namespace limb_ring::fault {

/// Every way in which a robot is broken, or mended, on purpose: the one vocabulary of scenarios, simulator,
/// daemons and tools. (ours)
enum class Name {
  // of a line
  cut,
  heal,
  drop,
  corrupt,
  truncate,
  duplicate,
  reorder,
  delay,
  rate,
  stall,
  flap,
  // of a node: controller and CPU
  kill,
  start,
  power_cycle,
  freeze,
  thaw,
  suspend,
  step_clock,
  // of a CPU; its controller goes on
  hang,
  resume,
  reset,
  crash,
  slow,
  not_reading,
  babble,
  mute
};

/// What a fault hits.
enum class Of { line, node, cpu };

/// The parameters of a fault, beside what it hits; fault_parse.h has a word for each.
enum Key : unsigned {
  kPackets = 1u << 0,
  kOnceIn = 1u << 1,
  kFor = 1u << 2,
  kAfter = 1u << 3,
  kAfterPackets = 1u << 4,
  kDelay = 1u << 5,
  kJitter = 1u << 6,
  kRate = 1u << 7,
  kEvery = 1u << 8,
  kSeed = 1u << 9,
  kForward = 1u << 10,
  kBack = 1u << 11,
  kMonotonic = 1u << 12
};

/// What a fault does to a CPU, be it a process or a model of one. Code that carries it out has a case for each and no
/// `default:`, which would hide a missing one.
enum class ToCpu : std::uint8_t {
  nothing,      ///< a fault of a line or node
  stop,         ///< it neither reads nor sends
  read_slowly,  ///< it takes one packet in each period `every`; 0: none
  babble,       ///< it sends all it can, or one packet in each period
  mute,         ///< what it asks to be sent is discarded
  cure,         ///< what it has of those above ends
  restart,
  crash
};

/// What there is to know of a fault: its word, what it hits, which parameters it takes, and how it ends.
struct Word {
  Name name;
  const char* word;
  Of of;
  unsigned keys;  ///< the parameters it takes, a set of Key
  const char* meaning;
  unsigned needs = 0;  ///< any of these keys has to be given; 0: none
  ToCpu to_cpu = ToCpu::nothing;
  /// Of a node or CPU: it lasts until one of these, a set of bit_of(), or its own time `for`; 0: it is over at once.
  std::uint32_t ended_by = 0;
  bool silences = false;  ///< while it lasts, nothing that the CPU sends goes out
};

constexpr unsigned kWhen = kFor | kAfter | kAfterPackets;       ///< of all lines' faults
constexpr unsigned kHits = kPackets | kOnceIn | kSeed | kWhen;  ///< of those that hit single packets

constexpr std::uint32_t bit_of(Name name) { return 1u << static_cast<unsigned>(name); }
constexpr std::uint32_t kPowerOff = bit_of(Name::kill) | bit_of(Name::power_cycle);
constexpr std::uint32_t kCured = bit_of(Name::resume) | bit_of(Name::reset) | bit_of(Name::crash) | kPowerOff;

/// In the order of Name.
constexpr Word kWords[] = {
    {Name::cut, "cut", Of::line, kWhen,
     "the wire breaks; the node downstream notices at once, over UDP after timeouts.silence"},
    {Name::heal, "heal", Of::line, 0, "ends all faults of a line"},
    {Name::drop, "drop", Of::line, kHits, "packets are lost"},
    {Name::corrupt, "corrupt", Of::line, kHits, "packets arrive with one bit flipped"},
    {Name::truncate, "truncate", Of::line, kHits, "data packets are cut off before their end"},
    {Name::duplicate, "duplicate", Of::line, kHits, "packets arrive twice in a row"},
    {Name::reorder, "reorder", Of::line, kHits,
     "packets arrive after the next one and are discarded, because a link keeps order"},
    {Name::delay, "delay", Of::line, kHits | kDelay | kJitter,
     "packets arrive later, by `delay` and a random time up to `jitter`, in order", kDelay | kJitter},
    {Name::rate, "rate", Of::line, kWhen | kRate, "limits the data rate of the line", kRate},
    {Name::stall, "stall", Of::line, kWhen, "nothing passes while it lasts; then everything arrives in order"},
    {Name::flap, "flap", Of::line, kWhen | kEvery, "the line is cut for the first half of each period, then healed",
     kEvery},
    {Name::kill, "kill", Of::node, 0, "the node dies, and its neighbours bypass it"},
    {Name::start, "start", Of::node, 0, "starts a dead or absent node"},
    {Name::power_cycle, "power_cycle", Of::node, 0, "switches the power of the node off, and at once on again"},
    {Name::freeze, "freeze", Of::node, kFor, "the node stops running and is bypassed", 0, ToCpu::nothing,
     bit_of(Name::thaw) | kPowerOff},
    {Name::thaw, "thaw", Of::node, 0, "a frozen or suspended node continues where it stopped"},
    {Name::suspend, "suspend", Of::node, kFor,
     "as freeze, but the node's monotonic clock stands too, as at the suspend of a host; name the host, or its nodes",
     0, ToCpu::nothing, bit_of(Name::thaw) | kPowerOff},
    {Name::step_clock, "step_clock", Of::node, kForward | kBack | kMonotonic,
     "sets the wall clock of the node, where its next boot number comes from, or makes its monotonic clock skip a time",
     kForward | kBack | kMonotonic},
    {Name::hang, "hang", Of::cpu, kFor, "the CPU neither reads nor sends", 0, ToCpu::stop, kCured, true},
    {Name::resume, "resume", Of::cpu, 0, "ends hang, slow, not_reading, babble and mute of a CPU", 0, ToCpu::cure},
    {Name::reset, "reset", Of::cpu, 0, "restarts the CPU, as its reset pin does", 0, ToCpu::restart},
    {Name::crash, "crash", Of::cpu, 0, "the program of the CPU crashes; its owner starts it again", 0, ToCpu::crash},
    {Name::slow, "slow", Of::cpu, kFor | kEvery, "the CPU reads one packet per period", kEvery, ToCpu::read_slowly,
     kCured},
    {Name::not_reading, "not_reading", Of::cpu, kFor, "the CPU sends, but reads no packets", 0, ToCpu::read_slowly,
     kCured},
    {Name::babble, "babble", Of::cpu, kFor | kEvery,
     "the CPU broadcasts packets of the largest size at the highest priority: one per period, or without `every` all "
     "it can",
     0, ToCpu::babble, kCured},
    {Name::mute, "mute", Of::cpu, kFor,
     "the CPU runs and reads; all packets and interrupts that it sends are discarded", 0, ToCpu::mute, kCured, true},
};

inline const Word& word_of(Name name) { return kWords[static_cast<std::size_t>(name)]; }

/// What a node is, by faults of it.
enum class Node : std::uint8_t { runs, frozen, dead };
/// What a fault of nodes makes of one; nothing if it cannot be done there: in a scenario it then changes nothing,
/// and else it is refused. A power cycle in a scenario is a kill of all its nodes, then a start.
std::optional<Node> after(Name fault, Node node);
/// It makes a node stand still that runs.
inline bool freezes(Name fault) { return fault == Name::freeze || fault == Name::suspend; }
/// It hits the process of a CPU, so there has to be one.
inline bool hits_process(Name fault) {
  return word_of(fault).to_cpu == ToCpu::stop || word_of(fault).to_cpu == ToCpu::crash;
}

/// All words, in the order of Name.
std::vector<std::string> words();
/// null if there is no such fault.
const Word* find_word(const std::string& word);

using std::chrono::nanoseconds;
using wire::NodeId;

/// One fault, or the end of one, as a value. Which members count is in Word::keys.
struct Fault {
  Name name = Name::cut;
  std::vector<NodeId> nodes;  ///< the nodes it hits; for a line: the node from which the line leads
  bool second_line = false;   ///< for a line: the second one of a ring that folds back, against ring order

  std::uint64_t packets = 0;  ///< the next so many; 0: no limit
  std::uint64_t once_in = 1;  ///< ... each with the probability 1 / once_in
  nanoseconds lasts{0};       ///< for so long from its start; 0: until it is mended

  nanoseconds after{0};             ///< starts so much later
  std::uint64_t after_packets = 0;  ///< ... and not before so many DATPs of node `of` have passed the line
  NodeId of{0};                     ///< retries count for it, hellos and beacons do not

  nanoseconds delay{0};
  nanoseconds jitter{0};            ///< at random from 0 to this, on top of `delay`
  std::uint64_t rate = 0;           ///< bit/s
  nanoseconds every{0};             ///< a period: of flap, slow, babble
  std::uint64_t seed = 0;           ///< of its random choices; 0: drawn from the seed of the line
  nanoseconds forward{0}, back{0};  ///< by so much a wall clock is set
  nanoseconds monotonic{0};         ///< so much a monotonic clock skips
};

}  // namespace limb_ring::fault
