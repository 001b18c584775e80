#include "config/urdf_limits.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "config/entry.h"
#include "config/quantity.h"
#include "config/ring_config.h"

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

std::string file_and_line(const UrdfJoints& urdf, const UrdfJoint& joint) {
  return urdf.path + ':' + std::to_string(joint.line);
}

const UrdfJoint& find_joint(const Entry& name, const UrdfJoints& urdf, const std::string& joint) {
  const auto found = urdf.joints.find(joint);
  if (found != urdf.joints.end()) return found->second;
  std::vector<std::string> driven;
  for (const auto& [other, one] : urdf.joints)
    if (one.has_motor()) driven.push_back(other);
  const std::string meant = closest(joint, driven);
  name.refuse(
      "there is no joint '" + joint + "' in " + urdf.path + (meant.empty() ? "" : ", did you mean '" + meant + "'?"),
      driven.empty() ? "a joint of it; none is revolute, continuous or prismatic" : join(driven));
}

void refuse_without_motor(const Entry& name, const UrdfJoints& urdf, const std::string& joint, const UrdfJoint& there) {
  if (there.mimic)
    name.refuse(
        "joint '" + joint + "' has no motor: it mimics '" + there.mimic->joint + "' in " + file_and_line(urdf, there),
        "to leave it out: it follows, and joint_states have it");
  if (!there.moves())
    name.refuse("joint '" + joint + "' is " + (there.type.empty() ? "of no type" : there.type) + " in " +
                    file_and_line(urdf, there),
                "a joint that is revolute, continuous or prismatic there");
}

JointConfig::Type type_of(const UrdfJoint& there) {
  if (there.type == "prismatic") return JointConfig::Type::prismatic;
  return there.type == "continuous" ? JointConfig::Type::continuous : JointConfig::Type::revolute;
}

bool is_position(const std::string& limit) { return limit == "lower" || limit == "upper"; }

std::optional<double> number_at(const UrdfJoint& there, const std::string& limit) {
  const auto found = there.limit.find(limit);
  return found == there.limit.end() ? std::nullopt : parse_real(found->second);
}

/// What the URDF gives, cut to what packets carry; nothing if it gives none. Many robots are published with an
/// effort or a velocity of 0, or none: they were made for simulators that do not read these. (ours)
std::optional<double> given(const UrdfJoint& there, const std::string& limit) {
  auto value = number_at(there, limit);
  if (is_position(limit)) {
    const bool either = there.limit.count("lower") != 0 || there.limit.count("upper") != 0;
    if (there.type == "continuous" || !either) return std::nullopt;
    return std::clamp(value.value_or(0), kPositions.least, kPositions.most);  // 0 by default, says the format
  }
  if (!value || *value <= 0) return std::nullopt;
  return std::min(*value, limit == "velocity" ? kVelocities.most : kEfforts.most);
}

}  // namespace

void read_urdf(const Entry& entry) {
  entry.document().urdf_unsure = true;
  const std::string path = urdf_path(entry);
  try {
    const std::string text = read_file(path);
    entry.document().urdf = parse_urdf(text, path);
    entry.document().files.push_back({path, text});
    entry.document().urdf_unsure = false;
  } catch (const ConfigError& error) {
    entry.refuse(error.what(), kAllowedUrdf);
  }
}

void take_usual_limits(JointConfig& joint) {
  JointConfig usual;
  usual.name = joint.name;
  usual.type = joint.type;
  joint = usual;
  if (joint.type == JointConfig::Type::continuous) joint.lower = kPositions.least, joint.upper = kPositions.most;
  if (joint.slides()) joint.lower = -1, joint.upper = 1, joint.velocity = 1, joint.effort = 500;
}

void take_urdf_limits(const Entry& name, JointConfig& joint) {
  const UrdfJoints& urdf = name.document().urdf;
  if (urdf.path.empty()) return;
  const UrdfJoint& there = find_joint(name, urdf, joint.name);
  refuse_without_motor(name, urdf, joint.name, there);
  joint.type = type_of(there);
  take_usual_limits(joint);
  joint.lower = given(there, "lower").value_or(joint.lower);
  joint.upper = given(there, "upper").value_or(joint.upper);
  joint.velocity = given(there, "velocity").value_or(joint.velocity);
  joint.effort = given(there, "effort").value_or(joint.effort);
}

void check_urdf_limit(const Entry& entry, const JointConfig& joint, const std::string& limit) {
  const UrdfJoints& urdf = entry.document().urdf;
  if (urdf.path.empty() || entry.find(limit)) return;
  const UrdfJoint& there = urdf.joints.at(joint.name);
  const auto written = there.limit.find(limit);
  const auto number = number_at(there, limit);
  if (written != there.limit.end() && !number)
    entry.refuse(
        "joint '" + joint.name + "' has " + limit + "=\"" + written->second + "\" in " + file_and_line(urdf, there),
        "a number, there or as '" + limit + "' here");
  const auto value = given(there, limit);
  auto& not_said = entry.document().not_said;
  if (number && value && *value != *number) not_said["far"].push_back(joint.name + "." + limit);
  if (limit == "upper" && value && joint.lower == joint.upper) not_said["range"].push_back(joint.name);
  if (value || limit == "upper" || (there.type == "continuous" && limit == "lower")) return;
  not_said[limit].push_back(joint.name);
}

std::vector<std::string> urdf_warnings(const Document& document) {
  JointConfig turns, slides;
  slides.type = JointConfig::Type::prismatic;
  take_usual_limits(slides);
  const auto taken_as = [&](double JointConfig::*limit, const char* angular, const char* linear) {
    return " (taken as " + format_real(turns.*limit) + angular + ", or " + format_real(slides.*limit) + linear +
           ") for ";
  };
  const std::map<std::string, std::string> words{
      {"lower", "no lower and upper" + taken_as(&JointConfig::upper, " rad", " m both ways")},
      {"velocity", "no velocity" + taken_as(&JointConfig::velocity, " rad/s", " m/s")},
      {"effort", "no effort" + taken_as(&JointConfig::effort, " N m", " N")},
      {"range", "no motion, because lower equals upper, for "},
      {"far", "values that do not fit into packets (cut to " + format_real(kPositions.most) + " both ways) for "}};
  std::string all;
  for (const auto& [what, joints] : document.not_said) all += (all.empty() ? "" : "; ") + words.at(what) + join(joints);
  if (all.empty()) return {};
  return {document.urdf.path + " has " + all + ". Give them there, or with the joint in the ring's file"};
}

void take_followers(const UrdfJoints& urdf, RingConfig& ring) {
  std::set<std::string> driven;
  for (const NodeConfig& node : ring.nodes)
    for (const JointConfig& joint : node.joints) driven.insert(joint.name);
  for (const std::string& name : urdf.order) {
    if (!urdf.joints.at(name).mimic) continue;
    const auto leader = urdf.leader_of(name);
    if (driven.count(leader.joint) != 0)
      ring.followers.push_back({name, leader.joint, leader.multiplier, leader.offset});
  }
}

}  // namespace limb_ring::config
