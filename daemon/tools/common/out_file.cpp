#include "tools/common/out_file.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace limb_ring::app {

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
