#pragma once

#include <string>

#include "capture/packet_way.h"
#include "capture/pcapng_writer.h"

namespace limb_ring::ringctl {

/// A way as a picture, SVG: nodes downwards in the order of the way, time to the right. On each node's
/// line out the packet's bar, light before it while it waited, grey what was in its way, INTPs as marks.
std::string way_svg(const capture::Way& way, const capture::RingNames& names);

}  // namespace limb_ring::ringctl
