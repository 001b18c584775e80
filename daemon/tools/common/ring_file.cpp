#include "tools/common/ring_file.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "config/quantity.h"
#include "io/program.h"
#include "tools/common/command_line.h"

namespace limb_ring::app {
namespace {

namespace fs = std::filesystem;

/// The user's own: as the XDG base directories have it. Empty if neither is known.
fs::path users_folder() {
  const char* config = std::getenv("XDG_CONFIG_HOME");
  if (config != nullptr && config[0] == '/') return fs::path(config) / "limb_ring";
  const char* home = std::getenv("HOME");
  return home == nullptr || home[0] == '\0' ? fs::path() : fs::path(home) / ".config" / "limb_ring";
}

/// PREFIX/share/limb_ring/config, the programs being in PREFIX/lib/limb_ring.
fs::path own_files() {
  const fs::path folder = process::own_folder();
  return folder.parent_path().parent_path() / "share" / "limb_ring" / "config";
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

}  // namespace

std::string ring_file(const std::string& given) {
  if (given.find_first_of("/.") != std::string::npos || is_file(given)) return given;
  std::string looked_in;
  for (const fs::path& folder : {users_folder(), fs::path("/etc/limb_ring"), own_files()}) {
    if (folder.empty()) continue;
    const fs::path path = folder / (given + ".yaml");
    if (is_file(path)) return path.string();
    looked_in += (looked_in.empty() ? "" : ", ") + folder.string();
  }
  throw config::ConfigError("there is no file " + given + ", and no ring " + given + ".yaml in " + looked_in);
}

namespace {

std::string cannot_be_written(const std::string& path, int error) {
  return path + ": cannot be written: " + std::strerror(error);
}

}  // namespace

std::string why_no_file(const std::string& path) {
  if (path != kStandardOutput) return "";
  return path + ": names no file here: standard output has the report; ./- is a file";
}

std::string why_not_writable(const std::string& path) {
  namespace fs = std::filesystem;
  if (const std::string problem = why_no_file(path); !problem.empty()) return problem;
  std::error_code error;
  if (fs::is_directory(path, error)) return cannot_be_written(path, EISDIR);
  const bool there = fs::exists(path, error);
  const std::string place = there ? path : fs::absolute(path, error).parent_path().string();
  return ::access(place.c_str(), there ? W_OK : W_OK | X_OK) == 0 ? "" : cannot_be_written(path, errno);
}

std::string open_for_writing(std::ofstream& file, const std::string& path) {
  if (const std::string problem = why_no_file(path); !problem.empty()) return problem;
  file.open(path, std::ios::binary);
  return file ? "" : cannot_be_written(path, errno);
}

std::string write_file(const std::string& path, const std::string& text) {
  std::ofstream file;
  if (const std::string problem = open_for_writing(file, path); !problem.empty()) return problem;
  file << text;
  return cli::finish_writing(file, path);
}

std::string make_output_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return "cannot make the folder " + folder + ": " + error.message();
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return "";
  return "cannot write into the folder " + folder + ": " + std::strerror(errno);
}

bool is_same_file(const std::string& one, const std::string& other) {
  std::error_code missing;
  return std::filesystem::equivalent(one, other, missing);
}

bool is_same_output(const std::string& one, const std::string& other) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (one.empty() || other.empty()) return false;
  if (fs::exists(one, error)) return fs::is_regular_file(one, error) && is_same_file(one, other);
  const fs::path path = fs::weakly_canonical(fs::absolute(one, error), error);
  return !path.empty() && path == fs::weakly_canonical(fs::absolute(other, error), error);
}

bool is_output_read() {
  pollfd output{STDOUT_FILENO, 0, 0};
  return ::poll(&output, 1, 0) <= 0 || (output.revents & POLLERR) == 0;
}

}  // namespace limb_ring::app
