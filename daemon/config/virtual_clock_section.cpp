#include "config/sections.h"

namespace limb_ring::config {

using namespace std::chrono_literals;

const Section<VirtualClockConfig>& virtual_clock_section() {
  static const Section<VirtualClockConfig> section{
      time_option("boot_time", &VirtualClockConfig::boot_time, 0ms, 60s,
                  "From a CPU's start to its first turn, by the ring's clock, however long that really takes."),
      time_option("stall", &VirtualClockConfig::stall, 10ms, 600s,
                  "Real time: a CPU that has not ended its turn by then is stuck, and the ring goes on without it."),
      integer_option("seed", &VirtualClockConfig::seed, {0, 1000000}, "Of the CPUs' jitter."),
  };
  return section;
}

}  // namespace limb_ring::config
