#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "node/babbling_cpu.h"
#include "node/cpu_socket.h"

namespace limb_ring::runtime {

/// Breaks the node's CPU on purpose, and mends it; the network controller goes on. A process is hit by
/// signals, whether it is our child or attached; what a CPU reads and sends is changed at its socket. (ours)
class CpuFaults {
 public:
  /// Called once: with an empty text when the action has taken effect, else with the reason why it has not.
  using Done = std::function<void(const std::string& problem)>;

  /// @param cpu_boot how long a CPU may take to boot (timeouts.cpu_boot)
  CpuFaults(boost::asio::io_context& io, NodeDriver& driver, CpuSocket& cpu, std::chrono::milliseconds cpu_boot)
      : io_(io), driver_(driver), cpu_(cpu), cpu_boot_(cpu_boot), babbling_(driver) {}

  /// Stops its process.
  void hang(const Done& done);
  /// Ends its process by SIGSEGV, as a wild pointer would.
  void crash(const Done& done);
  /// Done when it has booted again, or could not.
  void reset(const Done& done);
  void slow(core::Duration per_packet) { cpu_.read_throttle().one_per(per_packet); }
  void not_reading() { cpu_.read_throttle().not_at_all(); }
  void babble(std::chrono::nanoseconds period) { babbling_.start(period); }

  /// Its process goes on.
  void wake(const Done& done);
  void read_on();
  void be_quiet() { babbling_.stop(); }

  /// Its process is stopped, by us or by others. True as soon as we have sent SIGSTOP.
  bool hangs() const;
  std::uint64_t babbled() const { return babbling_.sent(); }
  void on_ended(const core::SendEnded& ended) { babbling_.on_ended(ended); }

 private:
  void wait(std::function<bool()> condition, const std::string& otherwise, const Done& done);

  boost::asio::io_context& io_;
  NodeDriver& driver_;
  CpuSocket& cpu_;
  std::chrono::milliseconds cpu_boot_;
  BabblingCpu babbling_;
  pid_t stopping_ = -1;                                     ///< it was sent SIGSTOP, which has not taken effect yet
  std::shared_ptr<void> alive_ = std::make_shared<int>(0);  ///< outlived by waits
};

}  // namespace limb_ring::runtime
