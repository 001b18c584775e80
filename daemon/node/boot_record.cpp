#include "node/boot_record.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <array>

#include "io/regular_file.h"
#include "wire/bytes.h"
#include "wire/packet.h"

namespace limb_ring::runtime {

namespace {

using Bytes = std::array<std::uint8_t, 8>;

}  // namespace

BootRecord::BootRecord(const std::string& directory, std::uint8_t id) {
  const std::string path = directory + "/" + std::to_string(id) + ".boot";
  fd_ = process::open_regular(path, O_RDWR | O_CREAT);
  if (!fd_.valid()) {
    spdlog::warn("{}: {}; the next process of this node cannot go on from this one's boot number", path,
                 process::why_not_opened(path));
    return;
  }
  Bytes bytes;
  if (::pread(fd_.get(), bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) return;
  last_ = wire::load_u64(bytes.data());
}

std::uint64_t BootRecord::first(std::uint64_t now_ns) const {
  if (last_ == 0) return now_ns;
  const std::uint64_t next = last_ + 1;
  if (now_ns <= next) return next;
  constexpr std::uint64_t kBits = 3;
  return (now_ns | kBits) + 1 + wire::incarnation_of(next);
}

void BootRecord::write(std::uint64_t boot) {
  last_ = boot;
  if (!fd_.valid()) return;
  Bytes bytes;
  wire::store_u64(bytes.data(), boot);
  // A failed write (disk full) is ignored: the next process then has only an older number to go on from.
  [[maybe_unused]] const ssize_t written = ::pwrite(fd_.get(), bytes.data(), bytes.size(), 0);
}

}  // namespace limb_ring::runtime
