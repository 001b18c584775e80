#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace limb_ring::config {

/// The text of a configuration, as_read() where that is kept. @throw ConfigError where it is no regular file, not
/// readable, or above 1 MiB
std::string read_file(const std::string& path);

/// @param name stands for the file in errors
/// @throw ConfigError where it is not YAML, not one document, or beyond YamlLimits
YAML::Node parse_yaml(const std::string& text, const std::string& name);

/// "FILE:LINE:COLUMN", counted from 1; FILE alone where the place is not known.
std::string place_in(const std::string& name, const YAML::Mark& mark);

}  // namespace limb_ring::config
