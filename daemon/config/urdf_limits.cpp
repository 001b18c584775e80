#include "config/urdf_limits.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "config/names.h"
#include "config/quantity.h"
#include "config/yaml_file.h"

namespace limb_ring::config {
namespace {

namespace fs = std::filesystem;

const char* const kAllowedUrdf =
    "a URDF: its path from the folder of this file, or absolute, or package://PACKAGE/PATH";

/// PACKAGE/PATH below the folders of ROS_PACKAGE_PATH, or in one that is the package itself.
std::string in_package(const Entry& entry, const std::string& package_and_path) {
  const std::string package = package_and_path.substr(0, package_and_path.find('/'));
  const char* folders = std::getenv("ROS_PACKAGE_PATH");
  std::istringstream all(folders ? folders : "");
  for (std::string folder; std::getline(all, folder, ':');) {
    std::error_code error;
    if (fs::exists(fs::path(folder) / package / "package.xml", error)) return (fs::path(folder) / package_and_path);
    if (fs::path(folder).filename() == package && fs::exists(fs::path(folder) / "package.xml", error))
      return fs::path(folder).parent_path() / package_and_path;
  }
  entry.refuse(folders ? "no folder of ROS_PACKAGE_PATH has the package '" + package + "'"
                       : "ROS_PACKAGE_PATH is not set, so no package is found",
               kAllowedUrdf);
}

std::string urdf_path(const Entry& entry) {
  const std::string scheme = "package://", written = entry.text(kAllowedUrdf);
  if (written.compare(0, scheme.size(), scheme) == 0) return in_package(entry, written.substr(scheme.size()));
  return (fs::path(entry.document().name).parent_path() / written).lexically_normal();
}

bool turns(const UrdfJoint& joint) { return joint.type == "revolute" || joint.type == "continuous"; }

std::string file_and_line(const UrdfJoints& urdf, const UrdfJoint& joint) {
  return urdf.path + ':' + std::to_string(joint.line);
}

const UrdfJoint& find_joint(const Entry& name, const UrdfJoints& urdf, const std::string& joint) {
  const auto found = urdf.joints.find(joint);
  if (found != urdf.joints.end()) return found->second;
  std::vector<std::string> turning;
  for (const auto& [other, one] : urdf.joints)
    if (turns(one)) turning.push_back(other);
  const std::string meant = closest(joint, turning);
  name.refuse(
      "there is no joint '" + joint + "' in " + urdf.path + (meant.empty() ? "" : ", did you mean '" + meant + "'?"),
      turning.empty() ? "a joint of it; none is revolute or continuous" : join(turning));
}

bool is_angle(const std::string& limit) { return limit == "lower" || limit == "upper"; }

bool is_unlimited(const UrdfJoint& joint, const std::string& limit) {
  return joint.type == "continuous" && is_angle(limit);
}

/// What the URDF gives; nothing where it gives none, or no plain number.
std::optional<double> given(const UrdfJoint& joint, const std::string& limit) {
  const auto found = joint.limit.find(limit);
  if (found != joint.limit.end()) return parse_real(found->second);
  if (is_angle(limit) && joint.has_limit) return 0.0;  // its default, says the format
  return std::nullopt;
}

double angle(const UrdfJoint& joint, const std::string& limit, double unlimited) {
  return is_unlimited(joint, limit) ? unlimited : given(joint, limit).value_or(unlimited);
}

}  // namespace

void read_urdf(const Entry& entry) {
  const std::string path = urdf_path(entry);
  try {
    entry.document().urdf = parse_urdf(read_file(path), path);
  } catch (const ConfigError& error) {
    entry.refuse(error.what(), kAllowedUrdf);
  }
}

void take_urdf_limits(const Entry& name, JointConfig& joint) {
  const UrdfJoints& urdf = name.document().urdf;
  if (urdf.path.empty()) return;
  const UrdfJoint& there = find_joint(name, urdf, joint.name);
  if (!turns(there))
    name.refuse("joint '" + joint.name + "' is " + there.type + " in " + file_and_line(urdf, there),
                "a joint that is revolute or continuous there: the joints of a ring turn");
  joint.lower = angle(there, "lower", kAngleRange.least);
  joint.upper = angle(there, "upper", kAngleRange.most);
  joint.velocity = given(there, "velocity").value_or(joint.velocity);
  joint.effort = given(there, "effort").value_or(joint.effort);
}

void check_urdf_limit(const Entry& entry, const JointConfig& joint, const std::string& limit, RealRange range) {
  const UrdfJoints& urdf = entry.document().urdf;
  if (urdf.path.empty() || entry.find(limit)) return;
  const UrdfJoint& there = urdf.joints.at(joint.name);
  const auto value = given(there, limit);
  if (is_unlimited(there, limit) || (value && *value >= range.least && *value <= range.most)) return;
  const auto written = there.limit.find(limit);
  const std::string found = written == there.limit.end() ? "no " + limit : limit + "=\"" + written->second + '"';
  entry.refuse("joint '" + joint.name + "' has " + found + " in " + file_and_line(urdf, there),
               allowed(range) + ", there or as '" + limit + "' here");
}

}  // namespace limb_ring::config
