#pragma once

#include <string>

#include "wire/packet_trace.h"
#include "wire/pcapng_writer.h"

namespace limb_ring::ringctl {

/// A trace as a picture, SVG: nodes downwards in the order of the path, time to the right. On each node's
/// line out the packet's bar, light before it while it waited, grey what was in its way, INTPs as marks.
std::string trace_svg(const capture::PacketTrace& trace, const capture::RingNames& names);

}  // namespace limb_ring::ringctl
