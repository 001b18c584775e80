#pragma once

#include <string>
#include <vector>

namespace limb_ring::study::scenario {

/// Every way in which a scenario breaks a robot, or mends it: the one vocabulary. (ours)
enum class FaultName {
  cut, heal, drop, corrupt, truncate,         // a line
  kill, start, power_cycle, freeze, thaw,     // a node: network controller and CPU
  hang, resume, reset, not_reading            // a CPU; its network controller goes on
};

/// What a fault is of, and so what stands behind its name in a file.
enum class FaultOf { line, packets, nodes };

struct FaultWord {
  FaultName name;
  const char* word;
  FaultOf of;
  const char* meaning;
};

/// In the order of FaultName. A link keeps order and never delivers twice (protocol.md section 6), so no
/// fault doubles a packet.
constexpr FaultWord kFaults[] = {
    {FaultName::cut, "cut", FaultOf::line, "the wire is broken; the node behind learns of it at once"},
    {FaultName::heal, "heal", FaultOf::line, "the line is as new: ends cut, drop, corrupt, truncate"},
    {FaultName::drop, "drop", FaultOf::packets, "packets do not arrive"},
    {FaultName::corrupt, "corrupt", FaultOf::packets, "packets arrive with one bit wrong"},
    {FaultName::truncate, "truncate", FaultOf::packets, "data packets break off before their end"},
    {FaultName::kill, "kill", FaultOf::nodes, "the node is dead; its neighbours bypass it"},
    {FaultName::start, "start", FaultOf::nodes, "a dead or absent node comes up"},
    {FaultName::power_cycle, "power_cycle", FaultOf::nodes, "off, and at once on again"},
    {FaultName::freeze, "freeze", FaultOf::nodes, "the node stands still and is bypassed"},
    {FaultName::thaw, "thaw", FaultOf::nodes, "a frozen node goes on where it stood"},
    {FaultName::hang, "hang", FaultOf::nodes, "the CPU neither reads nor sends"},
    {FaultName::resume, "resume", FaultOf::nodes, "a CPU that hangs or does not read goes on"},
    {FaultName::reset, "reset", FaultOf::nodes, "the CPU starts anew, as by its reset pin"},
    {FaultName::not_reading, "not_reading", FaultOf::nodes, "the CPU sends, but takes no packet"},
};

inline const FaultWord& word_of(FaultName name) { return kFaults[static_cast<std::size_t>(name)]; }

inline std::vector<std::string> fault_words() {
  std::vector<std::string> words;
  for (const FaultWord& fault : kFaults) words.emplace_back(fault.word);
  return words;
}

}  // namespace limb_ring::study::scenario
