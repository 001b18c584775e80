#include "config/yaml_file.h"

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "config/as_read.h"
#include "config/config_error.h"
#include "config/yaml_limits.h"

namespace limb_ring::config {
namespace {

constexpr std::size_t kMostBytes = 1 << 20;

/// Refuses what is not one document within its limits. yaml-cpp's own way through all documents never ends where a
/// comma follows the last one: it finds a next document there and never gets beyond it.
void check(const std::string& text, const std::string& name) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  YamlLimits first(name), second(name);
  if (!parser.HandleNextDocument(first))
    throw ConfigError(name + ": holds no YAML document; allowed: one, which is a map");
  if (parser.HandleNextDocument(second))
    throw ConfigError(place_in(name, second.start()) +
                      ": what begins here is not part of the YAML document; allowed: one document, which is a map");
}

/// yaml-cpp's own words do not say what stands there: it looks like blanks.
bool is_indented_by_a_tab(const std::string& text, const YAML::Mark& mark) {
  std::istringstream in(text);
  std::string line;
  for (int i = 0; i <= mark.line; ++i)
    if (!std::getline(in, line)) return false;
  return line.substr(0, line.find_first_not_of(" \t")).find('\t') != std::string::npos;
}

}  // namespace

YAML::Node parse_yaml(const std::string& text, const std::string& name) {
  try {
    check(text, name);
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const bool tab = is_indented_by_a_tab(text, error.mark);
    throw ConfigError(place_in(name, error.mark) + ": is not YAML: " + error.msg +
                      (tab ? "; the line is indented by a tab, allowed: blanks" : ""));
  }
}

std::string place_in(const std::string& name, const YAML::Mark& mark) {
  if (mark.is_null()) return name;
  return name + ':' + std::to_string(mark.line + 1) + ':' + std::to_string(mark.column + 1);
}

namespace {

/// Of a path from the current folder, which that is: most often it is another one than was thought.
std::string looked_in(const std::string& path) {
  std::error_code error;
  const auto folder = std::filesystem::current_path(error);
  if (error || std::filesystem::path(path).is_absolute()) return {};
  return " (looked in " + folder.string() + ")";
}

}  // namespace

// Only a regular file: reading a pipe or a device might never end.
std::string read_file(const std::string& path) {
  if (auto text = as_read(path)) return std::move(*text);
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw ConfigError(path + ": there is no such file" + looked_in(path));
  if (!std::filesystem::is_regular_file(status)) throw ConfigError(path + ": is not a file; allowed: a regular file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw ConfigError(path + ": cannot be read: " + std::strerror(errno));
  std::string text(kMostBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) throw ConfigError(path + ": cannot be read: " + std::strerror(errno));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kMostBytes) throw ConfigError(path + ": is too large; allowed: up to 1 MiB");
  return text;
}

}  // namespace limb_ring::config
