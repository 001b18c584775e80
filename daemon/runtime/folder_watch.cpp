#include "runtime/folder_watch.h"

#include <chrono>

#include <spdlog/spdlog.h>

#include "host/node_lock.h"
#include "process/own_log.h"

namespace limb_ring::runtime {
namespace {

constexpr std::chrono::milliseconds kPeriod{1000};
/// Within a second a CPU writes a gigabyte.
constexpr std::chrono::milliseconds kLogPeriod{50};
constexpr off_t kMostLog = 4 * 1024 * 1024;  // bytes of a daemon's log, with what its CPU writes

}  // namespace

FolderWatch::FolderWatch(boost::asio::io_context& io, Folder folder)
    : timer_(io), log_timer_(io), folder_(std::move(folder)) {}

void FolderWatch::start() {
  every(timer_, kPeriod, &FolderWatch::check_folder);
  every(log_timer_, kLogPeriod, &FolderWatch::check_log);
}

void FolderWatch::every(boost::asio::steady_timer& timer, std::chrono::milliseconds period,
                        void (FolderWatch::*check)()) {
  timer.expires_after(period);
  timer.async_wait([this, &timer, period, check, stopped = stopped_](const boost::system::error_code& error) {
    if (error || *stopped) return;
    (this->*check)();
    every(timer, period, check);
  });
}

void FolderWatch::stop() {
  *stopped_ = true;
  timer_.cancel();
  log_timer_.cancel();
}

void FolderWatch::check_log() {
  if (process::empty_long_log(folder_.path, kMostLog))
    spdlog::warn("this log had more than {} MiB, and begins anew", kMostLog >> 20);
}

void FolderWatch::check_folder() {
  if (folder_.is_in_place()) return;
  try {
    folder_.make_again();
    spdlog::warn("the runtime folder, or a file of this node in it, was removed and is made again");
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
