#include "node/node_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

namespace limb_ring::host {

namespace {

constexpr std::chrono::milliseconds kEnds{200}, kTryAgain{5};

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

/// Nothing where it cannot be had: the folder is only less safe then.
std::shared_ptr<process::UniqueFd> lock_against_cleaners(const std::string& directory) {
  static std::weak_ptr<process::UniqueFd> last;
  struct stat there {
  }, ours{};
  const auto is_same = [&](const process::UniqueFd& folder) {
    return ::stat(directory.c_str(), &there) == 0 && ::fstat(folder.get(), &ours) == 0 && there.st_ino == ours.st_ino &&
           there.st_dev == ours.st_dev;
  };
  if (auto folder = last.lock(); folder && is_same(*folder)) return folder;
  auto folder =
      std::make_shared<process::UniqueFd>(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW));
  (void)::flock(folder->get(), LOCK_SH | LOCK_NB);
  last = folder;
  return folder;
}

/// A daemon that was just killed may hold it a moment longer than it is heard.
std::optional<process::LockFile> take(const std::string& path) {
  const auto deadline = std::chrono::steady_clock::now() + kEnds;
  for (;;) {
    std::optional<process::LockFile> lock = process::LockFile::take(path);
    if (lock || std::chrono::steady_clock::now() >= deadline) return lock;
    std::this_thread::sleep_for(kTryAgain);
  }
}

process::LockFile taken(const std::string& path, const std::string& whose) {
  std::optional<process::LockFile> lock = take(path);
  if (!lock) throw NodeHeld(whose + " is held by " + process::lock_holder(path));
  return std::move(*lock);
}

}  // namespace

NodeLock::NodeLock(const std::string& directory, const std::string& ring, std::uint8_t id, const std::string& name)
    : folder_(lock_against_cleaners(directory)),
      file_(taken(directory + "/" + std::to_string(id) + ".lock",
                  "node " + std::to_string(id) + " (" + name + ") of ring " + ring)) {
  file_.write(own_description());
}

}  // namespace limb_ring::host
