#include "io/memory_queue.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "wire/data_packet.h"
#include "wire/slice.h"

namespace limb_ring::link {
namespace {

constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW;

bool is_capacity(std::size_t capacity) {
  return capacity >= QueueMemory::kSmallest && capacity <= QueueMemory::kLargest && (capacity & (capacity - 1)) == 0;
}

bool heard(const std::atomic<std::uint32_t>& beat, std::uint32_t& last) {
  const std::uint32_t now = beat.load(std::memory_order_relaxed);
  return std::exchange(last, now) != now;
}

}  // namespace

std::size_t queue_capacity(std::size_t nodes) {
  std::size_t capacity = QueueMemory::kSmallest;
  while (capacity < nodes * wire::kMaxSliceSize && capacity < QueueMemory::kLargest) capacity *= 2;
  return capacity;
}

// ---- the memory ---------------------------------------------------------------------------

QueueMemory::QueueMemory(process::UniqueFd fd, void* mapped, std::size_t capacity)
    : fd_(std::move(fd)), mapped_(mapped), capacity_(capacity) {}

QueueMemory::QueueMemory(QueueMemory&& other) noexcept
    : fd_(std::move(other.fd_)), mapped_(std::exchange(other.mapped_, nullptr)), capacity_(other.capacity_) {}

QueueMemory& QueueMemory::operator=(QueueMemory&& other) noexcept {
  std::swap(fd_, other.fd_);
  std::swap(mapped_, other.mapped_);
  std::swap(capacity_, other.capacity_);
  return *this;
}

QueueMemory::~QueueMemory() {
  if (mapped_ != nullptr) ::munmap(mapped_, sizeof(QueueControl) + capacity_);
}

std::optional<QueueMemory> QueueMemory::make(std::size_t capacity) {
  process::UniqueFd fd(::memfd_create("limb_ring line", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  const auto size = static_cast<off_t>(sizeof(QueueControl) + capacity);
  if (!fd.valid() || ::ftruncate(fd.get(), size) != 0) return std::nullopt;
  if (::fcntl(fd.get(), F_ADD_SEALS, kSeals | F_SEAL_SEAL) != 0) return std::nullopt;
  return map(std::move(fd), capacity);
}

// Without the seals its maker could shrink the memory, and our next access would kill this process.
std::optional<QueueMemory> QueueMemory::open(process::UniqueFd memory) {
  struct stat found {};
  const int seals = ::fcntl(memory.get(), F_GET_SEALS);
  if (seals < 0 || (seals & kSeals) != kSeals || ::fstat(memory.get(), &found) != 0) return std::nullopt;
  if (found.st_size < static_cast<off_t>(sizeof(QueueControl))) return std::nullopt;
  const auto capacity = static_cast<std::size_t>(found.st_size) - sizeof(QueueControl);
  if (!is_capacity(capacity)) return std::nullopt;
  return map(std::move(memory), capacity);
}

// Memory that is not there yet could be refused at any access, which kills this process.
std::optional<QueueMemory> QueueMemory::map(process::UniqueFd fd, std::size_t capacity) {
  const std::size_t size = sizeof(QueueControl) + capacity;
  int error;
  do error = ::posix_fallocate(fd.get(), 0, static_cast<off_t>(size));
  while (error == EINTR);
  if (error != 0) {
    errno = error;
    return std::nullopt;
  }
  void* mapped = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd.get(), 0);
  if (mapped == MAP_FAILED) return std::nullopt;
  return QueueMemory(std::move(fd), mapped, capacity);
}

// ---- the writer ---------------------------------------------------------------------------

std::ptrdiff_t QueueWriter::put(wire::ByteView bytes) {
  const std::uint64_t waiting = written_ - memory_->control().read.load(std::memory_order_acquire);
  if (waiting > memory_->capacity()) return -1;
  const std::size_t size = std::min(bytes.size, memory_->capacity() - static_cast<std::size_t>(waiting));
  const std::size_t at = written_ & (memory_->capacity() - 1);
  const std::size_t to_end = std::min(size, memory_->capacity() - at);
  std::memcpy(memory_->bytes() + at, bytes.data, to_end);
  std::memcpy(memory_->bytes(), bytes.data + to_end, size - to_end);
  written_ += size;
  memory_->control().written.store(written_);
  return static_cast<std::ptrdiff_t>(size);
}

// All four accesses are sequentially consistent: either this sees that the reader sleeps, or the reader sees what was
// put before it sleeps. The same holds for room.
bool QueueWriter::must_wake() {
  std::atomic<std::uint32_t>& sleeps = memory_->control().reader_sleeps;
  if (sleeps.load() == 0) return false;
  sleeps.store(0, std::memory_order_relaxed);
  return true;
}

bool QueueWriter::wait_for_room() {
  QueueControl& control = memory_->control();
  control.writer_waits.store(1);
  return written_ - control.read.load() >= memory_->capacity();
}

bool QueueWriter::heard_beat() { return heard(memory_->control().reader_beat, beat_); }

// ---- the reader ---------------------------------------------------------------------------

std::ptrdiff_t QueueReader::take(std::uint8_t* space, std::size_t size) {
  const std::uint64_t waiting = memory_->control().written.load(std::memory_order_acquire) - read_;
  if (waiting > memory_->capacity()) return -1;
  size = std::min(size, static_cast<std::size_t>(waiting));
  const std::size_t at = read_ & (memory_->capacity() - 1);
  const std::size_t to_end = std::min(size, memory_->capacity() - at);
  std::memcpy(space, memory_->bytes() + at, to_end);
  std::memcpy(space + to_end, memory_->bytes(), size - to_end);
  read_ += size;
  memory_->control().read.store(read_);
  return static_cast<std::ptrdiff_t>(size);
}

bool QueueReader::must_tell_of_room() {
  std::atomic<std::uint32_t>& waits = memory_->control().writer_waits;
  if (waits.load() == 0) return false;
  waits.store(0, std::memory_order_relaxed);
  return true;
}

bool QueueReader::sleep() {
  QueueControl& control = memory_->control();
  control.reader_sleeps.store(1);
  if (control.written.load() == read_) return true;
  control.reader_sleeps.store(0, std::memory_order_relaxed);
  return false;
}

bool QueueReader::heard_beat() { return heard(memory_->control().writer_beat, beat_); }

}  // namespace limb_ring::link
