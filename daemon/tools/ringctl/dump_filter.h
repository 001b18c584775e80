#pragma once

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "wire/packet_assembler.h"
#include "wire/packet_filter.h"
#include "wire/pcapng.h"

namespace limb_ring::ringctl {

/// The words for the ends of a line, and for capture::Kind.
inline const std::vector<std::string> kLines{"in", "out"};
inline const std::vector<std::string> kKinds{"data", "control", "interrupt"};

/// Which packets a command line asks for, in its own words.
struct FilterWords {
  std::vector<std::string> at, kinds, from, to;
  std::vector<unsigned> priority, channel;
  std::uint32_t sample = 1, limit = 0;
};

/// Id of a node by id or name. @throw UsageError listing those there are
wire::NodeId node_of(const std::string& word, const capture::RingNames& names);

/// @throw UsageError naming the word that is wrong, and what there is
capture::Choice choice_of(const FilterWords& words, const capture::RingNames& names);

/// As `packets` of an observe order (docs/reference/requests.md).
nlohmann::json order_of(const capture::Choice& choice);

/// What `trace` reads.
struct SeenPackets {
  capture::RingNames names;
  std::vector<capture::SeenPacket> packets;
  std::vector<capture::CapturedEvent> events;
  std::uint64_t lost = 0;  ///< missing: read too slowly, or more than the window of a live capture holds
};

/// Says on standard error what is wrong with a capture, as far as it was read.
void tell_problems(const capture::PcapngReader& reader);

/// All packets of a capture file. @throw capture::CaptureFileError
SeenPackets packets_of_file(const std::string& path);
/// What is on all lines of a running ring for so long, or until somebody asks it to end.
/// @throw HostPortError, NoRing
SeenPackets packets_of_ring(const std::string& ring, std::chrono::nanoseconds how_long);

}  // namespace limb_ring::ringctl
