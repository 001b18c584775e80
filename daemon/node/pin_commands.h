#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "io/child_process.h"

namespace limb_ring::runtime {

/// Runs the commands of pins wired to `exec`: side by side, but few, and none for ever. (ours)
class PinCommands {
 public:
  static constexpr std::size_t kAtOnce = 4;
  /// Shown by status as pin_commands_refused and so on.
  struct Counters {
    std::uint64_t refused = 0;    ///< the command is empty, its program is not found, or kAtOnce were running already
    std::uint64_t failed = 0;     ///< fork or exec failed, or it ended by a signal or with other than exit 0
    std::uint64_t timed_out = 0;  ///< killed at the deadline (also in `failed`)
  };

  PinCommands(boost::asio::io_context& io, std::chrono::milliseconds deadline, process::ProcessHandle::By by);

  /// Starts a command; its output goes to our standard error.
  /// @return why not; empty where it was started (its end is logged and counted).
  std::string run(const std::vector<std::string>& command, process::SpawnRequest request);
  /// Kills what is running.
  void stop();
  const Counters& counters() const { return counters_; }

 private:
  struct Slot {
    Slot(boost::asio::io_context& io, process::ProcessHandle::By by) : child(io, by), deadline(io) {}
    process::ChildProcess child;
    boost::asio::steady_timer deadline;
    std::string name;
  };
  Slot* free_slot();
  std::string refuse(std::string why);
  void start(Slot& slot, const process::SpawnRequest& request);
  void ended(Slot& slot, const process::ExitStatus& status);
  void timed_out(Slot& slot);

  std::chrono::milliseconds deadline_;
  std::array<Slot, kAtOnce> slots_;
  Counters counters_;
  std::shared_ptr<void> alive_ = std::make_shared<int>(0);  ///< outlived by queued handlers
};

}  // namespace limb_ring::runtime
