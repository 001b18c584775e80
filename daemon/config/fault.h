#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "wire/packet.h"

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
  // of a CPU; its controller goes on
  hang,
  resume,
  reset,
  crash,
  slow,
  not_reading,
  babble
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
  kSeed = 1u << 9
};

/// What there is to know of a fault: its word, what it hits, which parameters it takes.
struct Word {
  Name name;
  const char* word;
  Of of;
  unsigned keys;  ///< the parameters it takes, a set of Key
  const char* meaning;
};

constexpr unsigned kWhen = kFor | kAfter | kAfterPackets;       ///< of all lines' faults
constexpr unsigned kHits = kPackets | kOnceIn | kSeed | kWhen;  ///< of those that hit single packets

/// In the order of Name.
constexpr Word kWords[] = {
    {Name::cut, "cut", Of::line, kWhen,
     "the wire is broken; the node behind learns of it at once, over UDP by the silence"},
    {Name::heal, "heal", Of::line, 0, "the line is as new: ends all faults of a line"},
    {Name::drop, "drop", Of::line, kHits, "packets do not arrive"},
    {Name::corrupt, "corrupt", Of::line, kHits, "packets arrive with one bit wrong"},
    {Name::truncate, "truncate", Of::line, kHits, "data packets break off before their end"},
    {Name::duplicate, "duplicate", Of::line, kHits, "packets arrive twice, one right behind the other"},
    {Name::reorder, "reorder", Of::line, kHits,
     "packets come behind the next one, and are discarded as late: a link keeps order"},
    {Name::delay, "delay", Of::line, kHits | kDelay | kJitter,
     "packets come later by `delay`, and at random by up to `jitter`; in order"},
    {Name::rate, "rate", Of::line, kWhen | kRate, "the line carries no more than that data rate"},
    {Name::stall, "stall", Of::line, kWhen, "nothing passes while it lasts, then all goes on in order"},
    {Name::flap, "flap", Of::line, kWhen | kEvery, "cut for the first half of each period, then healed"},
    {Name::kill, "kill", Of::node, 0, "the node is dead; its neighbours bypass it"},
    {Name::start, "start", Of::node, 0, "a dead or absent node comes up"},
    {Name::power_cycle, "power_cycle", Of::node, 0, "its power goes off and at once on again"},
    {Name::freeze, "freeze", Of::node, kFor, "the node stands still and is bypassed"},
    {Name::thaw, "thaw", Of::node, 0, "a frozen node goes on where it stood"},
    {Name::hang, "hang", Of::cpu, kFor, "the CPU neither reads nor sends"},
    {Name::resume, "resume", Of::cpu, 0, "ends hang, slow, babble and not_reading of a CPU"},
    {Name::reset, "reset", Of::cpu, 0, "the CPU restarts, as by its reset pin"},
    {Name::crash, "crash", Of::cpu, 0, "the CPU dies by itself; whoever keeps it starts it again"},
    {Name::slow, "slow", Of::cpu, kFor | kEvery, "the CPU takes one packet in each period"},
    {Name::not_reading, "not_reading", Of::cpu, kFor, "the CPU sends, but takes no packet"},
    {Name::babble, "babble", Of::cpu, kFor | kEvery,
     "the CPU sends the largest packets to all at the highest priority, one in each period; without `every` all it "
     "can"},
};

inline const Word& word_of(Name name) { return kWords[static_cast<std::size_t>(name)]; }

/// All words, in the order of Name.
std::vector<std::string> words();
/// null where there is no such fault.
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
  nanoseconds jitter{0};   ///< at random from 0 to this, on top of `delay`
  std::uint64_t rate = 0;  ///< bit/s
  nanoseconds every{0};    ///< a period: of flap, slow, babble
  std::uint64_t seed = 0;  ///< of its random choices; 0: drawn from the seed of the line
};

}  // namespace limb_ring::fault
