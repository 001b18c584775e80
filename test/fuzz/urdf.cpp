// A robot's URDF, of which the limits of joints are read.
#include "config/quantity.h"
#include "config/urdf_joints.h"
#include "fuzz/fuzz.h"

using namespace limb_ring;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto urdf = config::parse_urdf({reinterpret_cast<const char*>(data), size}, "robot.urdf");
    for (const auto& joint : urdf.joints) fuzz::require(!joint.first.empty(), "a joint has a name");
  } catch (const config::ConfigError& problem) {
    fuzz::require(problem.what()[0] != '\0', "a problem is named");
  }
  return 0;
}
