#include "io/lock_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <sstream>
#include <stdexcept>

#include "io/process_state.h"
#include "io/regular_file.h"
#include "io/throw_errno.h"

namespace limb_ring::process {
namespace {

UniqueFd opened(const std::string& path) {
  const std::string problem = why_not_regular(path);
  if (!problem.empty()) throw std::runtime_error(problem + ": it cannot be locked; remove it");
  UniqueFd file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file.valid()) throw_errno("cannot open " + path);
  return file;
}

bool try_lock(int fd) {
  struct flock whole_file {};
  whole_file.l_type = F_WRLCK;
  whole_file.l_whence = SEEK_SET;
  return ::fcntl(fd, F_OFD_SETLK, &whole_file) == 0;
}

}  // namespace

// A file that is removed between its opening and its locking is nobody's lock any more.
std::optional<LockFile> LockFile::take(const std::string& path) {
  for (;;) {
    LockFile lock(path, opened(path));
    if (!try_lock(lock.file_.get())) {
      if (errno != EAGAIN && errno != EACCES) throw_errno("cannot lock " + path);
      return std::nullopt;
    }
    if (lock.is_in_place()) return lock;
  }
}

void LockFile::write(const std::string& text) const {
  const bool written = ::ftruncate(file_.get(), 0) == 0 &&
                       ::pwrite(file_.get(), text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
  if (!written) throw_errno("cannot write " + path_);
}

bool LockFile::is_in_place() const {
  struct stat ours {
  }, there{};
  return ::fstat(file_.get(), &ours) == 0 && ::stat(path_.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

void LockFile::remove() const {
  if (is_in_place()) ::unlink(path_.c_str());
}

std::string lock_holder(const std::string& path) {
  pid_t pid = 0;
  std::istringstream(text_of_regular(path)) >> pid;
  if (pid <= 0) return "another process";
  const std::string program = program_of(pid);
  const std::string text = "pid " + std::to_string(pid);
  return program.empty() ? text : text + " (" + program + ")";
}

}  // namespace limb_ring::process
