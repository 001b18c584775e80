#pragma once

#include <poll.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <string>

namespace limb_ring::ringd {

/// The daemon's log on standard error, which does not wait for whoever reads it: a terminal after Ctrl-S, or a pipe
/// nobody empties, must not stop the ring. It waits kPatience once, since a reader may just be busy with other daemons'
/// lines. What does not fit is left out, counted, and told once there is room. Each line is one write, so that lines of
/// several daemons do not mix. The daemon has one thread.
class StderrSink final : public spdlog::sinks::stderr_color_sink_st {
 public:
  StderrSink() { std::setvbuf(stderr, nullptr, _IOFBF, kLongest); }
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

  static constexpr std::size_t kLongest = 4096;  ///< bytes, PIPE_BUF: a pipe that polls writable takes so many
  static constexpr int kPatience = 2;            ///< ms

  bool has_room() {
    pollfd entry{STDERR_FILENO, POLLOUT, 0};
    is_read_ = ::poll(&entry, 1, is_read_ ? kPatience : 0) > 0;
    return is_read_;
  }

  void tell_left_out() {
    if (left_out_ == 0) return;
    const std::string text =
        std::to_string(left_out_) + (left_out_ == 1 ? " line" : " lines") + " left out: standard error was not read";
    left_out_ = 0;
    Base::log(spdlog::details::log_msg("ringd", spdlog::level::warn, text));
  }

  bool is_read_ = true;
  std::uint64_t left_out_ = 0;
};

}  // namespace limb_ring::ringd
