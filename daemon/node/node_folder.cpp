#include "node/node_folder.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <array>
#include <chrono>

#include "io/process_state.h"
#include "io/regular_file.h"
#include "limb_ring/ring_directory.h"
#include "node/host_server.h"
#include "wire/bytes.h"
#include "wire/packet.h"

namespace limb_ring::runtime {

NodeFolder::NodeFolder(const config::RingConfig& ring, const config::NodeConfig& node)
    : ring_(ring),
      node_(node),
      path_(make_ring_directory(ring.ring)),
      lock_(std::in_place, path_, ring.ring, node.id, node.name),
      boots_(std::in_place, path_, node.id) {}

void NodeFolder::make_again() {
  make_ring_directory(ring_.ring);
  if (!is_in_place()) lock_.emplace(path_, ring_.ring, node_.id, node_.name);
  boots_.emplace(path_, node_.id);
}

std::uint64_t NodeFolder::first_boot() const {
  const std::chrono::nanoseconds since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return boots_->first(static_cast<std::uint64_t>(since_1970.count()));
}

namespace {

constexpr std::chrono::seconds kPeriod{1};
/// Within a second a CPU writes a gigabyte. A quiet link's usual tick, which it shares: nobody wakes for it alone.
constexpr std::chrono::milliseconds kLogPeriod{50};
constexpr off_t kMostLog = 4 * 1024 * 1024;  // bytes of a daemon's log, with what its CPU writes

}  // namespace

FolderWatch::FolderWatch(boost::asio::io_context& io, Folder folder)
    : io_(io), timer_(io), folder_(std::move(folder)) {}

void FolderWatch::start() {
  check_folder_later();
  log_ticker_.emplace(io_, kLogPeriod, [this](event_loop::Ticker::Time) { check_log(); });
}

void FolderWatch::check_folder_later() {
  timer_.expires_after(kPeriod);
  timer_.async_wait([this, stopped = stopped_](const boost::system::error_code& error) {
    if (error || *stopped) return;
    check_folder();
    check_folder_later();
  });
}

void FolderWatch::stop() {
  *stopped_ = true;
  timer_.cancel();
  log_ticker_.reset();
}

void FolderWatch::check_log() {
  if (process::empty_long_log(folder_.path, kMostLog))
    spdlog::warn("this log had more than {} MiB, and begins again", kMostLog >> 20);
}

void FolderWatch::check_folder() {
  if (folder_.is_in_place()) return;
  try {
    folder_.make_again();
    spdlog::warn("the runtime folder, or a file of this node in it, was removed or truncated, and has been made again");
    told_ = false;
  } catch (const host::NodeHeld& taken) {
    spdlog::error("the runtime folder was removed, and {}: ending", taken.what());
    folder_.give_up();
  } catch (const std::exception& problem) {
    if (!std::exchange(told_, true))
      spdlog::warn("the runtime folder was removed and cannot be made again yet: {}", problem.what());
  }
}

namespace {

using Bytes = std::array<std::uint8_t, 8>;

}  // namespace

BootRecord::BootRecord(const std::string& directory, std::uint8_t id) {
  const std::string path = directory + "/" + std::to_string(id) + ".boot";
  fd_ = process::open_regular(path, O_RDWR | O_CREAT);
  if (!fd_.valid()) {
    spdlog::warn("{}: {}; the next process of this node cannot continue this one's boot number", path,
                 process::why_not_opened(path));
    return;
  }
  Bytes bytes;
  if (::pread(fd_.get(), bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) return;
  last_ = wire::load_u64(bytes.data());
}

std::uint64_t BootRecord::first(std::uint64_t now_ns) const {
  return last_ == 0 ? now_ns : wire::next_boot(last_, now_ns);
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
