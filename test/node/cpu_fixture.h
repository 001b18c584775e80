#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "io/node_clock.h"
#include "io/process_state.h"
#include "node/cpu_process.h"
#include "support/run_until.h"

namespace limb_ring::runtime {

using namespace std::chrono_literals;
using process::process_state;
using test::run_until;

/// A CPU of real processes, and an event loop to run it with. The test plays the host
/// port: it says when a process has attached.
class CpuProcessTest : public ::testing::Test, public CpuEvents {
 protected:
  /// What a process that attaches says of its owner; of a child it does not count.
  static constexpr bool kOwnerRestartsIt = true, kNobodyRestartsIt = false;

  void on_cpu_changed() override { ++changes; }

  CpuOptions child(std::vector<std::string> command) {
    CpuOptions options;
    options.cpu.kind = config::CpuConfig::Kind::child;
    options.cpu.command = std::move(command);
    options.back_off = {1ms, 8ms, 10s};
    return options;
  }

  CpuProcess& start(CpuOptions options) {
    cpu = std::make_unique<CpuProcess>(io, clock, std::move(options), *this);
    cpu->start();
    return *cpu;
  }

  CpuStatus status() const { return cpu->status(); }
  bool until(const std::function<bool()>& condition) { return run_until(io, condition); }
  bool until_new_child(pid_t old) {
    return until([&] { return status().pid > 0 && status().pid != old; });
  }
  bool until_stopped(pid_t pid) {
    return until([&] { return process_state(pid) == 'T'; });
  }

  boost::asio::io_context io;
  event_loop::MachineClock clock{io};
  std::unique_ptr<CpuProcess> cpu;
  int changes = 0;
};

/// A process of nobody's but the test's, killed and waited for at its end.
class Outsider {
 public:
  Outsider() {
    process::SpawnRequest request;
    request.path = "/bin/sleep";
    request.arguments = {"sleep", "1000"};
    pid_ = spawn(request).pid;
  }
  ~Outsider() { end(); }
  Outsider(const Outsider&) = delete;
  Outsider& operator=(const Outsider&) = delete;

  pid_t pid() const { return pid_; }
  void end() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    reap();
  }
  /// Waits for its end. @return its wait status.
  int reap() {
    int wait_status = 0;
    ::waitpid(std::exchange(pid_, -1), &wait_status, 0);
    return wait_status;
  }

 private:
  pid_t pid_ = -1;
};

}  // namespace limb_ring::runtime
