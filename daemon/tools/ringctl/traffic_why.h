#pragma once

#include <string>
#include <vector>

#include "wire/packet_trace.h"
#include "wire/pcapng.h"

namespace limb_ring::ringctl {

/// "DATP 0/3 of left_knee to body, 52 B" or "INT1 0/3 of body to all": a packet that was seen.
std::string packet_words(const capture::SeenPacket& packet, const capture::RingNames& names);
/// "body -> waist  DATP 0/3  p2 joint  52 B": what a trace is about.
std::string title_of(const capture::PacketTrace& trace, const capture::RingNames& names);
/// How it ended, and where not at home, where it was seen last.
std::string end_words(const capture::PacketTrace& trace, const capture::RingNames& names);
/// Why it is another try, one sentence each; none if it is the first.
std::vector<std::string> retry_words(const capture::PacketTrace& trace, const capture::RingNames& names);
/// What happened at that hop and on the line to it, in words; empty if nothing did.
std::string hop_words(const capture::PacketTrace& trace, std::size_t hop, const capture::RingNames& names);
/// "12.384", in us to the nanosecond.
std::string in_us(std::chrono::nanoseconds time);

}  // namespace limb_ring::ringctl
