// A scenario's YAML file.
#include "fuzz/fuzz.h"
#include "sim/load_scenario.h"

using namespace limb_ring;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    scenario::parse_scenario({reinterpret_cast<const char*>(data), size}, "scenario.yaml");
  } catch (const config::ConfigError& problem) {
    fuzz::require(problem.what()[0] != '\0', "a problem is named");
  }
  return 0;
}
