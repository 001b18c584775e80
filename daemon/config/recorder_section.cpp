#include "config/sections.h"

namespace limb_ring::config {

const Section<RecorderConfig>& recorder_section() {
  static const Section<RecorderConfig> section{
      flag_option("enabled", &RecorderConfig::enabled, "Record, on a live ring; as `ringctl up --record`."),
      integer_option("size", &RecorderConfig::size, {1u << 20, 1u << 30},
                     "Bytes of each node's file; the newest stays. It lies in the ring's runtime folder."),
  };
  return section;
}

}  // namespace limb_ring::config
