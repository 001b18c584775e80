#pragma once

#include <map>
#include <string>

namespace limb_ring::config {

/// A joint as a URDF has it: values as they are written there.
struct UrdfJoint {
  int line = 0;
  std::string type;                          ///< revolute, continuous, fixed ...
  bool has_limit = false;                    ///< has the element <limit>
  std::map<std::string, std::string> limit;  ///< its attributes: lower, upper, velocity, effort
};

/// The joints of a URDF, by name.
struct UrdfJoints {
  std::string path;  ///< empty: there is no URDF
  std::map<std::string, UrdfJoint> joints;
};

/// @param path stands for the file in errors
/// @throw ConfigError `FILE:LINE: PROBLEM` where it is not XML, no URDF, or has a joint without a name or two of one
UrdfJoints parse_urdf(const std::string& text, const std::string& path);

}  // namespace limb_ring::config
