#include "host/node_lock.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>
#include <utility>

namespace limb_ring::host {

namespace {

/// Our arguments without the program, each ended by a null, as the kernel has them.
std::string own_arguments() {
  std::ifstream file("/proc/self/cmdline");
  std::string program;
  std::getline(file, program, '\0');
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string own_description() {
  namespace fs = std::filesystem;
  std::error_code unknown;  // leaves it empty
  return std::to_string(getpid()) + '\n' + fs::read_symlink("/proc/self/exe", unknown).string() + '\0' +
         fs::current_path(unknown).string() + '\0' + own_arguments();
}

process::LockFile taken(const std::string& path, const std::string& whose) {
  std::optional<process::LockFile> lock = process::LockFile::take(path);
  if (!lock) throw NodeHeld(whose + " is held by " + process::lock_holder(path));
  return std::move(*lock);
}

}  // namespace

NodeLock::NodeLock(const std::string& directory, const std::string& ring, std::uint8_t id, const std::string& name)
    : file_(taken(directory + "/" + std::to_string(id) + ".lock",
                  "node " + std::to_string(id) + " (" + name + ") of ring " + ring)) {
  file_.write(own_description());
}

}  // namespace limb_ring::host
