#include "judge/observation_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "io/unique_fd.h"

namespace limb_ring::promises {

namespace {

constexpr std::array<char, 8> kRingMagic{'l', 'i', 'm', 'b', 's', 'e', 'e', '1'};
/// Half a MiB: more than half a second of the fastest ring.
constexpr std::size_t kCapacity = 16384;
/// This many of the oldest records in the file are not read: the writer may be overwriting them.
constexpr std::uint64_t kBeingWritten = 64;

}  // namespace

struct ObservationRing {
  std::array<char, 8> magic;
  alignas(64) std::atomic<std::uint64_t> count;  ///< complete; the newest one is at (count - 1) % kCapacity
  alignas(64) std::array<Observation, kCapacity> all;
};

namespace {

[[noreturn]] void fail_with(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

MappedRing map_ring(int fd, int protection, const std::string& path) {
  void* memory = ::mmap(nullptr, sizeof(ObservationRing), protection, MAP_SHARED | MAP_POPULATE, fd, 0);
  if (memory == MAP_FAILED) fail_with(errno, "cannot map " + path);
  return MappedRing(static_cast<ObservationRing*>(memory));
}

// Disk space is allocated now: if the disk filled up later, a write to the mapping would end the daemon by SIGBUS.
MappedRing make_ring(const std::string& path) {
  ::unlink(path.c_str());
  const process::UniqueFd file(::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file.valid()) fail_with(errno, "cannot make " + path);
  const int error = ::posix_fallocate(file.get(), 0, sizeof(ObservationRing));
  if (error != 0) {
    ::unlink(path.c_str());
    fail_with(error, "no room for " + path);
  }
  return map_ring(file.get(), PROT_READ | PROT_WRITE, path);
}

MappedRing open_ring(const std::string& path) {
  const process::UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!file.valid()) fail_with(errno, "cannot read " + path);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || status.st_size != static_cast<off_t>(sizeof(ObservationRing)))
    throw std::runtime_error(path + " holds no observations of this version");
  MappedRing ring = map_ring(file.get(), PROT_READ, path);
  if (ring->magic != kRingMagic) throw std::runtime_error(path + " holds no observations");
  return ring;
}

}  // namespace

void UnmapRing::operator()(ObservationRing* ring) const { ::munmap(ring, sizeof(ObservationRing)); }

ObservationFile::ObservationFile(std::string path) : path_(std::move(path)), ring_(make_ring(path_)) {
  ring_->magic = kRingMagic;
}

ObservationFile::~ObservationFile() { ::unlink(path_.c_str()); }

bool ObservationFile::is_there() const { return ::access(path_.c_str(), F_OK) == 0; }

void ObservationFile::make_again() {
  MappedRing again = make_ring(path_);
  again->all = ring_->all;
  again->count.store(count_, std::memory_order_release);
  again->magic = kRingMagic;
  ring_ = std::move(again);
}

void ObservationFile::put(const Observation& seen) {
  ring_->all[count_ % kCapacity] = seen;
  ring_->count.store(++count_, std::memory_order_release);
}

ObservationReader::ObservationReader(const std::string& path, std::uint64_t from)
    : ring_(open_ring(path)), next_(from) {}

void ObservationReader::follow(const std::string& path) { ring_ = open_ring(path); }

std::uint64_t ObservationReader::read(std::vector<Observation>& seen) {
  seen.clear();
  const std::uint64_t count = ring_->count.load(std::memory_order_acquire);
  const std::uint64_t first = next_;
  std::uint64_t from = count > kCapacity ? std::max(first, count - kCapacity + kBeingWritten) : first;
  for (std::uint64_t i = from; i < count; ++i) seen.push_back(ring_->all[i % kCapacity]);
  std::atomic_thread_fence(std::memory_order_acquire);
  // Drops what the writer has overwritten during the copy.
  const std::uint64_t now = ring_->count.load(std::memory_order_relaxed);
  const std::uint64_t good = now + kBeingWritten > kCapacity ? now + kBeingWritten - kCapacity : 0;
  if (good > from) {
    const std::uint64_t bad = std::min<std::uint64_t>(good - from, seen.size());
    seen.erase(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(bad));
    from += bad;
  }
  next_ = count;
  return from - first;
}

}  // namespace limb_ring::promises
