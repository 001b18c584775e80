#include "io/find_program.h"

#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>

namespace limb_ring::process {

namespace {

bool executable_file(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && S_ISREG(info.st_mode) && ::access(path.c_str(), X_OK) == 0;
}

std::string find_on_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string candidate = (folder.empty() ? "." : folder) + "/" + name;
    if (executable_file(candidate)) return candidate;
  }
  return {};
}

std::string working_folder() {
  char path[PATH_MAX];
  return ::getcwd(path, sizeof path) != nullptr ? path : "a folder that is gone";
}

}  // namespace

std::string own_folder() {
  char path[PATH_MAX];
  const ssize_t size = ::readlink("/proc/self/exe", path, sizeof path);
  if (size <= 0) return {};
  const std::string full(path, static_cast<std::size_t>(size));
  return full.substr(0, full.rfind('/'));
}

std::string find_program(const std::string& name, const std::string& folder) {
  if (name.empty()) return {};
  if (name.find('/') != std::string::npos) return executable_file(name) ? name : std::string{};
  const std::string beside = folder + "/" + name;
  if (!folder.empty() && executable_file(beside)) return beside;
  return find_on_path(name);
}

std::string no_program(const std::string& name, const std::string& folder) {
  const std::string what = "no program '" + name + "' that can be executed";
  if (name.find('/') == std::string::npos) return what + " (looked in " + folder + " and on PATH)";
  if (name.front() == '/') return what;
  return what + " (seen from " + working_folder() + ")";
}

}  // namespace limb_ring::process
