#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace limb_ring::config {

/// A joint as a URDF has it: values as they are written there.
struct UrdfJoint {
  /// `position * multiplier + offset` of another joint: it has no motor of its own.
  struct Mimic {
    std::string joint;
    double multiplier = 1, offset = 0;
  };

  int line = 0;
  std::string type;                          ///< revolute, continuous, prismatic, fixed ...
  std::string parent, child;                 ///< links
  bool has_limit = false;                    ///< has the element <limit>
  std::map<std::string, std::string> limit;  ///< its attributes: lower, upper, velocity, effort
  std::optional<Mimic> mimic;

  /// revolute, continuous or prismatic: one value says where it is.
  bool moves() const { return type == "revolute" || type == "continuous" || type == "prismatic"; }
  bool has_motor() const { return moves() && !mimic; }
};

/// The joints of a URDF, by name.
struct UrdfJoints {
  std::string path;   ///< empty: there is no URDF
  std::string robot;  ///< its name
  std::map<std::string, UrdfJoint> joints;
  std::vector<std::string> order;  ///< their names as the file has them

  /// The joint with a motor that `joint` follows, directly or by way of others, and how. @pre it mimics one
  UrdfJoint::Mimic leader_of(const std::string& joint) const;
};

/// @param path stands for the file in errors
/// @throw ConfigError `FILE:LINE: PROBLEM` for all that is wrong: not XML, no URDF but something else, which it names
///        with what makes a URDF of it; a joint without a name, two of one, one of a type that URDF does
///        not have, one that mimics nobody or itself; with `whole` also what keeps the links from being a robot, and
///        limits that no joint can have
/// @param whole the robot is of interest, not only the limits of joints that a ring's file names
UrdfJoints parse_urdf(const std::string& text, const std::string& path, bool whole = false);

/// `text` as it may stand in XML, in an attribute or between tags. Whatever it holds: each byte that XML does not
/// allow, or that is not UTF-8, is U+FFFD.
std::string xml_text(const std::string& text);

}  // namespace limb_ring::config
