#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>

namespace limb_ring::event_loop {

class PacketLoop;

/// A descriptor that packets come through, watched by the PacketLoop until stop() or destruction: it stays in the
/// loop's epoll set, so that waiting for it again costs nothing. Edge-triggered: after a call, read until there is
/// nothing left, or ask to be called again.
class Watch {
 public:
  /// What came: EPOLLIN, EPOLLOUT, EPOLLRDHUP, EPOLLHUP, EPOLLERR; 0 after call_again().
  using OnReady = std::function<void(std::uint32_t events)>;

  Watch() = default;
  /// @param fd stays open longer than this watches it
  /// @param events as epoll_ctl() takes them
  /// @throw std::system_error where the kernel takes no more of them, or `fd` cannot be waited for
  Watch(boost::asio::io_context& io, int fd, std::uint32_t events, OnReady on_ready);
  Watch(Watch&&) noexcept = default;
  Watch& operator=(Watch&& other) noexcept;
  ~Watch() { stop(); }

  /// Waits for these events from now on. @pre watching
  void set_events(std::uint32_t events);
  /// Calls back in the loop's next turn even if nothing comes; the others get their turn before. @pre watching
  void call_again();
  /// No call after this, also not one that is due. May be called from within a call.
  void stop();

 private:
  friend class PacketLoop;
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace limb_ring::event_loop
