#include "config/yaml_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "config/config_error.h"

namespace limb_ring::config {
namespace {

constexpr std::uintmax_t kMostBytes = 1 << 20;
constexpr std::size_t kMostDepth = 64;

/// yaml-cpp before 0.7 recurses without a limit; so deep brackets never get to it.
void check_depth(const std::string& text, const std::string& name) {
  std::size_t depth = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (depth > kMostDepth)
      throw ConfigError(name + ": brackets are nested too deep; allowed: " +
                        std::to_string(kMostDepth) + " levels");
  }
}

}  // namespace

YAML::Node parse_yaml(const std::string& text, const std::string& name) {
  check_depth(text, name);
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() != 1)
      throw ConfigError(name + ": holds " + std::to_string(documents.size()) +
                        " YAML documents; allowed: one, which is a map");
    return documents[0];
  } catch (const YAML::Exception& error) {
    const std::string place = error.mark.is_null()
                                  ? ""
                                  : ':' + std::to_string(error.mark.line + 1) + ':' +
                                        std::to_string(error.mark.column + 1);
    throw ConfigError(name + place + ": is not YAML: " + error.msg);
  }
}

// Only a regular file: reading a pipe or a device might never end.
std::string read_file(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw ConfigError(path + ": there is no such file");
  if (!std::filesystem::is_regular_file(status))
    throw ConfigError(path + ": is not a file; allowed: a regular file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw ConfigError(path + ": cannot be read: " + std::strerror(errno));
  if (std::filesystem::file_size(path, error) > kMostBytes)
    throw ConfigError(path + ": is too large; allowed: up to 1 MiB");
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace limb_ring::config
