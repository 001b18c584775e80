#include "io/regular_file.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

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

struct MappedFile::Guard {
  std::atomic<std::uintptr_t> begin{0};  ///< 0: this one is free
  std::atomic<std::size_t> size{0};
  std::atomic<bool> cut_off{false};
};

namespace {

/// Two for each node of the largest ring, in a process that has them all.
std::array<MappedFile::Guard, 512> guards;
struct sigaction former_action;

MappedFile::Guard* guard_of(std::uintptr_t address) {
  for (MappedFile::Guard& guard : guards) {
    const std::uintptr_t begin = guard.begin.load();
    if (begin != 0 && address >= begin && address - begin < guard.size.load()) return &guard;
  }
  return nullptr;
}

/// From the page of `address` on, memory of our own comes in the file's place.
bool put_zeros(const MappedFile::Guard& guard, std::uintptr_t address) {
  const std::uintptr_t page = address & ~(static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE)) - 1);
  const std::size_t size = guard.begin.load() + guard.size.load() - page;
  void* const there = reinterpret_cast<void*>(page);
  return ::mmap(there, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == there;
}

// Whatever is not ours happens once more as soon as this returns, and then as if this had never been here.
void on_bus_error(int, siginfo_t* info, void*) {
  const int error = errno;
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  MappedFile::Guard* const guard = info->si_code == BUS_ADRERR ? guard_of(address) : nullptr;
  if (guard != nullptr && put_zeros(*guard, address))
    guard->cut_off = true;
  else
    ::sigaction(SIGBUS, &former_action, nullptr);
  errno = error;
}

void handle_bus_errors() {
  static std::once_flag once;
  std::call_once(once, [] {
    struct sigaction action {};
    action.sa_sigaction = on_bus_error;
    action.sa_flags = SA_SIGINFO;
    ::sigaction(SIGBUS, &action, &former_action);
  });
}

MappedFile::Guard* take_guard(void* data, std::size_t size) {
  for (MappedFile::Guard& guard : guards) {
    std::uintptr_t free = 0;
    if (!guard.begin.compare_exchange_strong(free, reinterpret_cast<std::uintptr_t>(data))) continue;
    guard.cut_off = false;
    guard.size = size;
    return &guard;
  }
  errno = ENOMEM;
  return nullptr;
}

}  // namespace

MappedFile MappedFile::make(const std::string& path, std::size_t size) {
  ::unlink(path.c_str());
  const UniqueFd file(::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file.valid()) throw_errno("cannot make " + path);
  try {
    allocate(file, size, path);
  } catch (...) {
    ::unlink(path.c_str());
    throw;
  }
  return MappedFile(file, size, PROT_READ | PROT_WRITE, path);
}

MappedFile::MappedFile(const UniqueFd& file, std::size_t size, int protection, const std::string& path)
    : data_(::mmap(nullptr, size, protection, MAP_SHARED | MAP_POPULATE, file.get(), 0)), size_(size), guard_(nullptr) {
  if (data_ == MAP_FAILED) throw_errno("cannot map " + path);
  handle_bus_errors();
  guard_ = take_guard(data_, size);
  if (guard_ != nullptr) return;
  ::munmap(data_, size_);
  throw_errno("cannot map " + path);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(other.data_), size_(other.size_), guard_(std::exchange(other.guard_, nullptr)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(guard_, other.guard_);
  return *this;
}

MappedFile::~MappedFile() {
  if (guard_ == nullptr) return;
  guard_->size = 0;
  guard_->begin = 0;
  ::munmap(data_, size_);
}

bool MappedFile::is_cut_off() const { return guard_->cut_off; }

void allocate(const UniqueFd& file, std::size_t size, const std::string& path) {
  int error;
  do error = ::posix_fallocate(file.get(), 0, static_cast<off_t>(size));
  while (error == EINTR);
  if (error != 0) throw std::system_error(error, std::generic_category(), "no room for " + path);
}

}  // namespace limb_ring::process
