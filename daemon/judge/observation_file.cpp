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

ObservationRing* in(const process::MappedFile& file) { return static_cast<ObservationRing*>(file.data()); }

process::MappedFile open_ring(const std::string& path) {
  const process::UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!file.valid()) fail_with(errno, "cannot read " + path);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || status.st_size != static_cast<off_t>(sizeof(ObservationRing)))
    throw std::runtime_error(path + " holds no observations of this version");
  process::MappedFile ring(file, sizeof(ObservationRing), PROT_READ, path);
  if (in(ring)->magic != kRingMagic) throw std::runtime_error(path + " holds no observations");
  return ring;
}

}  // namespace

ObservationFile::ObservationFile(std::string path)
    : path_(std::move(path)), file_(process::MappedFile::make(path_, sizeof(ObservationRing))), ring_(in(file_)) {
  ring_->magic = kRingMagic;
}

ObservationFile::~ObservationFile() { ::unlink(path_.c_str()); }

bool ObservationFile::is_there() const {
  struct stat found {};
  return ::stat(path_.c_str(), &found) == 0 && found.st_size == static_cast<off_t>(file_.size()) && !file_.is_cut_off();
}

// Of what was cut off nothing is kept: a reader of it goes on at count().
void ObservationFile::make_again() {
  process::MappedFile again = process::MappedFile::make(path_, sizeof(ObservationRing));
  in(again)->all = ring_->all;
  in(again)->count.store(count_, std::memory_order_release);
  in(again)->magic = kRingMagic;
  file_ = std::move(again);
  ring_ = in(file_);
}

void ObservationFile::put(const Observation& seen) {
  ring_->all[count_ % kCapacity] = seen;
  ring_->count.store(++count_, std::memory_order_release);
}

ObservationReader::ObservationReader(const std::string& path, std::uint64_t from)
    : file_(open_ring(path)), ring_(in(file_)), next_(from) {}

void ObservationReader::follow(const std::string& path, std::uint64_t from) {
  (void)ring_->count.load();  // finds out whether it was cut off
  if (file_.is_cut_off()) lost_ += from - std::exchange(next_, from);
  file_ = open_ring(path);
  ring_ = in(file_);
}

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
  if (file_.is_cut_off()) {  // what was copied may be what is there in its place
    seen.clear();
    return 0;
  }
  next_ = count;
  return from - first + std::exchange(lost_, 0);
}

}  // namespace limb_ring::promises
