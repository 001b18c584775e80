#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "wire/pcapng_reader.h"
#include "wire/seen_packet.h"

namespace limb_ring::ringctl {

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
