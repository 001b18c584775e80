#include "io/memory_line.h"

#include <fcntl.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "io/unix_line.h"
#include "wire/packet.h"
#include "wire/slice.h"

namespace limb_ring::link {

MemoryDownstream::MemoryDownstream(boost::asio::io_context& io, std::string path, const Identity& self,
                                   std::size_t candidate, std::size_t capacity, Owner& owner, OutputCounters& counters)
    : UnixDownstream(io, std::move(path), self, candidate, owner, counters), capacity_(capacity) {}

bool MemoryDownstream::greet(const LinkHeader& connect) {
  memory_ = QueueMemory::make(capacity_);
  // A limit on files (ulimit -f) stays as it is, so this is not an attempt to be made again: it ends the daemon.
  if (!memory_ && errno == EFBIG)
    throw std::runtime_error(std::string("cannot make the queue of a line: ") + std::strerror(errno));
  const process::UniqueFd others_end = make_wake();
  if (!memory_ || !others_end.valid()) {
    ++counters().queue_unavailable;
    return false;
  }
  queue_.emplace(*memory_);
  LinkHeader header = connect;
  header.type = LinkHeaderType::connect_memory;
  const auto bytes = encode_connect(header, agreement());
  const auto sent = send_now(socket(), {bytes.data(), bytes.size()}, {memory_->fd(), others_end.get()});
  return sent == static_cast<ssize_t>(bytes.size());
}

process::UniqueFd MemoryDownstream::make_wake() {
  std::array<int, 2> ends{-1, -1};
  if (::pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC) != 0) return {};
  wake_.reset(ends[1]);
  return process::UniqueFd(ends[0]);
}

std::ptrdiff_t MemoryDownstream::put(wire::ByteView slices, std::string& reason) {
  const std::ptrdiff_t taken = queue_->put(slices);
  if (taken < 0) {
    ++counters().queue_invalid;
    reason = kInvalidQueue;
  } else if (queue_->must_wake()) {
    (void)!::write(wake_.get(), "", 1);  // full, or without a reader: then there is nobody to wake
  }
  return taken;
}

// The reader sends a header when there is room.
std::uint32_t MemoryDownstream::wait_for_room() {
  if (!queue_->wait_for_room()) try_again();
  return EPOLLIN;
}

// Nothing to read here: headers come only with an end, or with room, and both wake this end.
void MemoryDownstream::tick() {
  if (queue_->heard_beat()) heard();
}

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

namespace {

/// Reads in a row, before the host port and the timers get their turn.
constexpr int kMostReads = 8;
/// The pipe is emptied this often: each time would cost a system call a packet, and the smallest pipe holds 4096 wakes.
constexpr unsigned kWakesToEmpty = 1024;

}  // namespace

process::UniqueFd open_wake(const process::UniqueFd& given) {
  struct stat found {};
  if (::fstat(given.get(), &found) != 0 || !S_ISFIFO(found.st_mode)) return {};
  const std::string path = "/proc/self/fd/" + std::to_string(given.get());
  return process::UniqueFd(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
}

MemoryStream::MemoryStream(boost::asio::io_context& io, process::UniqueFd socket, QueueMemory memory,
                           process::UniqueFd wake, const LinkHeader& alive, Owner& owner, InputHandler& handler,
                           InputCounters& counters)
    : UnixStream(io, std::move(socket), alive, owner, handler, counters),
      memory_(std::move(memory)),
      queue_(memory_),
      wake_(std::move(wake)),
      woken_(io, wake_.get(), EPOLLIN, [this](std::uint32_t events) { on_woken(events); }) {
  woken_.call_again();
}

// Each byte that is written wakes, also if those before it are still in the pipe; but a full pipe wakes nobody.
void MemoryStream::on_woken(std::uint32_t events) {
  if (events != 0 && ++wakes_ % kWakesToEmpty == 0) {
    std::array<char, 4096> bytes;
    (void)!::read(wake_.get(), bytes.data(), bytes.size());
  }
  read();
}

void MemoryStream::read() {
  const auto self = shared_from_this();  // the handler may close the input
  if (ended_if_given_up()) return;
  int reads = 0;
  do {
    while (read_once())
      if (++reads == kMostReads) return woken_.call_again();
    if (!open()) return;
  } while (!queue_.sleep());
  if (ending()) owner().on_ended("its end was closed");
}

bool MemoryStream::read_once() {
  const auto got = queue_.take(feed().space(), feed().space_size());
  if (got < 0) {
    ++counters().queue_invalid;
    owner().on_ended(kInvalidQueue);
    return false;
  }
  if (got == 0) return false;
  woken_.found_packets();
  if (queue_.must_tell_of_room()) say_alive();
  take(static_cast<std::size_t>(got));
  return open();
}

void MemoryStream::tick() {
  queue_.beat();
  if (!queue_.heard_beat()) return;
  ++counters().beats;
  owner().on_heard();
}

void MemoryStream::close() {
  woken_.stop();
  UnixStream::close();
}

}  // namespace limb_ring::link
