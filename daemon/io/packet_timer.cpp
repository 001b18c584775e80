#include "io/packet_timer.h"

#include <sys/epoll.h>

#include <algorithm>

#include "io/timer_fd.h"

namespace limb_ring::event_loop {

PacketTimer::PacketTimer(boost::asio::io_context& io, std::function<void()> on_time)
    : timer_(make_timer()), watch_(io, timer_.get(), EPOLLIN, [call = std::move(on_time)](std::uint32_t) { call(); }) {}

// At least 1 ns: 0 would disarm the timer.
void PacketTimer::expires_at(std::chrono::steady_clock::time_point when) {
  const std::chrono::nanoseconds at =
      std::max(std::chrono::nanoseconds(1), std::chrono::nanoseconds(when.time_since_epoch()));
  set_timer(timer_.get(), TFD_TIMER_ABSTIME, at, {});
}

void PacketTimer::cancel() { set_timer(timer_.get(), 0, {}, {}); }

}  // namespace limb_ring::event_loop
