#include "io/regular_file.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "io/process_state.h"
#include "io/unique_fd.h"

namespace limb_ring::process {
namespace {

/// Empty if it is a regular file, or nothing is there.
std::string other_kind(const std::string& path) {
  struct stat found {};
  if (::lstat(path.c_str(), &found) != 0 || S_ISREG(found.st_mode)) return "";
  const mode_t mode = found.st_mode;
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISLNK(mode)) return "a symbolic link";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

}  // namespace

UniqueFd open_regular(const std::string& path, int flags) {
  UniqueFd file(::open(path.c_str(), flags | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW, 0600));
  struct stat found {};
  if (!file.valid() || (::fstat(file.get(), &found) == 0 && S_ISREG(found.st_mode))) return file;
  file.reset();
  errno = EINVAL;
  return file;
}

std::string why_not_regular(const std::string& path) {
  const std::string kind = other_kind(path);
  return kind.empty() ? "" : path + " is " + kind + ", not a regular file";
}

std::string why_not_opened(const std::string& path) {
  const int error = errno;
  const std::string kind = other_kind(path);
  return kind.empty() ? std::strerror(error) : "it is " + kind + ", not a regular file; remove it";
}

std::string text_of(const UniqueFd& file) {
  std::string text;
  std::array<char, 4096> part{};
  for (ssize_t got = 0; (got = ::pread(file.get(), part.data(), part.size(), static_cast<off_t>(text.size()))) > 0;)
    text.append(part.data(), static_cast<std::size_t>(got));
  return text;
}

std::string text_of_regular(const std::string& path) {
  const UniqueFd file = open_regular(path);
  return file.valid() ? text_of(file) : "";
}

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

namespace fs = std::filesystem;

namespace {

constexpr const char* kRandomPart = "XXXXXX";

std::string lock_in(const std::string& folder) { return folder + "/owner.lock"; }

bool is_ours(const std::string& folder) {
  struct stat status {};
  return ::lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == ::geteuid();
}

/// @return nothing if somebody has taken the folder for one that was left behind
std::optional<LockFile> locked(const std::string& folder) try {
  return LockFile::take(lock_in(folder));
} catch (const std::system_error& problem) {
  if (problem.code() == std::errc::no_such_file_or_directory) return std::nullopt;
  ::rmdir(folder.c_str());
  throw;
}

/// The lock last: whoever is killed in between leaves a folder that the next one removes.
void remove_folder(const std::string& folder) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (it->path() != lock_in(folder)) fs::remove_all(it->path(), ignored);
  }
  ::unlink(lock_in(folder).c_str());
  ::rmdir(folder.c_str());
}

// One without the file is just being made, and then made again, or what is left of one.
void remove_if_left(const std::string& folder) try {
  if (!is_ours(folder)) return;
  std::error_code ignored;
  if (!fs::exists(lock_in(folder), ignored)) {
    ::rmdir(folder.c_str());
  } else if (const auto lock = LockFile::take(lock_in(folder))) {
    remove_folder(folder);
  }
} catch (const std::system_error&) {  // it is gone, or stays
}

void remove_those_left(const std::string& prefix) {
  std::error_code error;
  for (fs::directory_iterator it(fs::path(prefix).parent_path(), error), end; !error && it != end; it.increment(error))
    if (it->path().string().rfind(prefix, 0) == 0) remove_if_left(it->path().string());
}

}  // namespace

TemporaryFolder::TemporaryFolder(const std::string& purpose) {
  const std::string prefix = (fs::temp_directory_path() / ("limb_ring_" + purpose + '_')).string();
  remove_those_left(prefix);
  while (!lock_) {
    path_ = prefix + kRandomPart;
    if (::mkdtemp(path_.data()) == nullptr) throw_errno("cannot make a folder " + path_);
    lock_ = locked(path_);
  }
}

TemporaryFolder::~TemporaryFolder() { remove_folder(path_); }

}  // namespace limb_ring::process
