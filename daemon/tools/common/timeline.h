#pragma once

#include <iosfwd>
#include <vector>

#include "wire/packet_assembler.h"
#include "wire/pcapng.h"

namespace limb_ring::app {

/// A capture as Chrome's trace JSON, which ui.perfetto.dev loads: a track for each line and for each node's CPU. A
/// packet is a slice on every line that it was on, and arrows lead from line to line; an INTP is an instant, as are
/// events. (ours)
///
/// A line shows packets as they came in at its end; if the capture has no inputs of it, as they went out. Times are us
/// since the first of all, to the ns; `otherData` has that instant by the capture's clock.
/// @param packets in any order
void write_timeline(std::ostream& out, const capture::RingNames& names, const std::vector<capture::SeenPacket>& packets,
                    const std::vector<capture::CapturedEvent>& events);

/// The same of a capture, pcapng. @param name of it, for errors. @throw capture::CaptureFileError
void write_timeline(std::ostream& out, std::istream& capture, const std::string& name);

}  // namespace limb_ring::app
