// A ring's YAML file.
#include "config/load_ring.h"
#include "fuzz/fuzz.h"

using namespace limb_ring;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const config::RingConfig ring = config::parse_ring({reinterpret_cast<const char*>(data), size}, "ring.yaml");
    fuzz::require(!ring.nodes.empty() && ring.nodes.size() <= 255, "a ring has 1 to 255 nodes");
  } catch (const config::ConfigError& problem) {
    fuzz::require(problem.what()[0] != '\0', "a problem is named");
  }
  return 0;
}
