#include "io/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <mutex>
#include <system_error>
#include <utility>

#include "io/unique_fd.h"

namespace limb_ring::process {

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
