#pragma once

#include <memory>
#include <ostream>
#include <vector>

#include "judge/replayed_ring.h"
#include "wire/pcapng_writer.h"

namespace limb_ring::recorder {

/// Writes what is on the lines of a replayed ring as pcapng, by the dates at which it was recorded. (ours)
class ReplayCapture {
 public:
  /// Both must outlive this.
  ReplayCapture(ReplayedRing& ring, std::ostream& out);
  ~ReplayCapture();

 private:
  class NodeTap;
  capture::PcapngWriter writer_;
  std::vector<std::unique_ptr<NodeTap>> taps_;  ///< of each life
};

}  // namespace limb_ring::recorder
