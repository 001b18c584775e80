#pragma once

#include <poll.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <unistd.h>

#include <cstdint>
#include <string>

namespace limb_ring::ringd {

/// The daemon's log on standard error, which never waits: whoever reads it may be stopped (a
/// terminal after Ctrl-S, a pipe nobody empties), and the ring must not stop with it. What does not
/// fit is left out, counted, and told once there is room. The daemon has one thread.
class StderrSink final : public spdlog::sinks::stderr_color_sink_st {
 public:
  void log(const spdlog::details::log_msg& message) override {
    if (!has_room()) {
      ++left_out_;
      return;
    }
    tell_left_out();
    Base::log(message);
  }

 private:
  using Base = spdlog::sinks::stderr_color_sink_st;

  /// A pipe that polls writable takes 4096 bytes (PIPE_BUF) without waiting.
  static bool has_room() {
    pollfd entry{STDERR_FILENO, POLLOUT, 0};
    return ::poll(&entry, 1, 0) > 0;
  }

  void tell_left_out() {
    if (left_out_ == 0) return;
    const std::string text = std::to_string(left_out_) + " lines left out: standard error was not read";
    left_out_ = 0;
    Base::log(spdlog::details::log_msg("ringd", spdlog::level::warn, text));
  }

  std::uint64_t left_out_ = 0;
};

}  // namespace limb_ring::ringd
