#include "host/node_lock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include "host/throw_errno.h"
#include "process/process_state.h"

namespace limb_ring::host {

namespace {

process::UniqueFd open_lock_file(const std::string& path) {
  process::UniqueFd file(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file.valid()) throw_errno("cannot open " + path);
  return file;
}

/// A lock of the open file (F_OFD_SETLK). Others can query it without taking it (live/lock_files.cpp), so that a
/// process that only asks is never mistaken for a holder.
bool try_lock(int fd) {
  struct flock whole_file {};
  whole_file.l_type = F_WRLCK;
  whole_file.l_whence = SEEK_SET;
  return fcntl(fd, F_OFD_SETLK, &whole_file) == 0;
}

/// "pid 4711 (ringd)", as far as can be known.
std::string holder_of(const std::string& path) {
  pid_t pid = 0;
  std::ifstream(path) >> pid;
  if (pid <= 0) return "another process";
  const std::string program = process::program_of(pid);
  const std::string text = "pid " + std::to_string(pid);
  return program.empty() ? text : text + " (" + program + ")";
}

/// Our arguments without the program, one a line.
std::string own_arguments() {
  std::ifstream file("/proc/self/cmdline");
  std::string program;
  std::getline(file, program, '\0');
  std::string text{std::istreambuf_iterator<char>(file), {}};
  std::replace(text.begin(), text.end(), '\0', '\n');
  return text;
}

std::string own_description() {
  namespace fs = std::filesystem;
  std::error_code unknown;  // leaves its line empty
  return std::to_string(getpid()) + '\n' + fs::read_symlink("/proc/self/exe", unknown).string() + '\n' +
         fs::current_path(unknown).string() + '\n' + own_arguments();
}

void write_holder(int fd, const std::string& path) {
  const std::string text = own_description();
  const bool written =
      ftruncate(fd, 0) == 0 && pwrite(fd, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
  if (!written) throw_errno("cannot write " + path);
}

/// False if our file was removed: 'ringctl down' may do so, for a ring that has ended, just after we opened it.
bool is_still_at(const std::string& path, int fd) {
  struct stat ours {
  }, there{};
  return fstat(fd, &ours) == 0 && stat(path.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

}  // namespace

NodeLock::NodeLock(const std::string& directory, const std::string& ring, std::uint8_t id, const std::string& name)
    : path_(directory + "/" + std::to_string(id) + ".lock"), file_(open_lock_file(path_)) {
  while (try_lock(file_.get()) && !is_still_at(path_, file_.get())) file_ = open_lock_file(path_);
  if (!try_lock(file_.get())) {
    if (errno != EAGAIN && errno != EACCES) throw_errno("cannot lock " + path_);
    throw NodeHeld("node " + std::to_string(id) + " (" + name + ") of ring " + ring + " is held by " +
                   holder_of(path_));
  }
  write_holder(file_.get(), path_);
}

bool NodeLock::is_in_place() const { return is_still_at(path_, file_.get()); }

}  // namespace limb_ring::host
