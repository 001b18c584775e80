#include "node/folder_watch.h"

#include <chrono>

#include <spdlog/spdlog.h>

#include "io/own_log.h"
#include "node/node_lock.h"

namespace limb_ring::runtime {
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
    spdlog::warn("this log had more than {} MiB, and begins anew", kMostLog >> 20);
}

void FolderWatch::check_folder() {
  if (folder_.is_in_place()) return;
  try {
    folder_.make_again();
    spdlog::warn("the runtime folder, or a file of this node in it, was removed or cut off, and is made again");
    told_ = false;
  } catch (const host::NodeHeld& taken) {
    spdlog::error("the runtime folder was removed, and {}: ending", taken.what());
    folder_.give_up();
  } catch (const std::exception& problem) {
    if (!std::exchange(told_, true))
      spdlog::warn("the runtime folder was removed and cannot be made again yet: {}", problem.what());
  }
}

}  // namespace limb_ring::runtime
