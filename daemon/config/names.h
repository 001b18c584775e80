#pragma once

#include <string>
#include <vector>

#include "limb_ring/ring_directory.h"

namespace limb_ring::config {

/// What the names in a configuration may look like (ours), each with its rule in words.
constexpr const char* kRingNameRule = "1 to 32 letters, digits, '-', '_' and '.', not beginning with '.' or '-'";
constexpr const char* kNodeNameRule = "a letter, then letters, digits and '_', 32 at most, and not the word 'all'";
constexpr const char* kHostNameRule =
    "a letter, then letters, digits, '_', '-' and '.', 64 at most, and not the word 'all'";
constexpr const char* kPartNameRule = "a letter, then letters, digits, '_', '-' and '.', 64 at most";
constexpr const char* kJointNameRule =
    "a letter, a digit, '_' or '/', then letters, digits, '_', '-', '.' and '/', 64 at most";
constexpr const char* kSensorNameRule = "a letter, then letters, digits and '_', 64 at most";
constexpr const char* kTopicNameRule =
    "a ROS topic name, not a private one: a letter or '/', then letters, digits, '_' and '/', 200 at most";

using limb_ring::is_ring_name;
bool is_node_name(const std::string& name);
/// A machine that runs nodes.
bool is_host_name(const std::string& name);
/// A stream of `traffic` or of a scenario.
bool is_part_name(const std::string& name);
/// As robot descriptions have it, with the '/' of ROS names.
bool is_joint_name(const std::string& name);
/// A sensor's name is part of its topic's, in which ROS allows neither '-' nor '.'.
bool is_sensor_name(const std::string& name);
bool is_topic_name(const std::string& name);

/// The one of `candidates` that `word` was probably meant to be; empty where none is close.
std::string closest(const std::string& word, const std::vector<std::string>& candidates);

/// "a, b, c"
std::string join(const std::vector<std::string>& words, const std::string& between = ", ");

}  // namespace limb_ring::config
