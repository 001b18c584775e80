#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>

namespace limb_ring::event_loop {

class PacketLoop;

/// A descriptor that packets come through, watched by the PacketLoop until stop() or destruction: it stays in the
/// loop's epoll set, so that waiting for it again costs nothing.
class Watch {
 public:
  enum class Trigger : std::uint8_t {
    edge,  ///< calls once for what comes: read until there is nothing left, or ask to be called again
    level  ///< calls in each turn in which there is something
  };
  /// What came: EPOLLIN, EPOLLOUT, EPOLLRDHUP, EPOLLHUP, EPOLLERR; 0 after call_again().
  using OnReady = std::function<void(std::uint32_t events)>;

  Watch() = default;
  /// @param fd stays open longer than this watches it
  /// @param events as epoll_ctl() takes them, without EPOLLET
  /// @throw std::system_error where the kernel takes no more of them, or `fd` cannot be waited for
  Watch(boost::asio::io_context& io, int fd, std::uint32_t events, OnReady on_ready, Trigger trigger = Trigger::edge);
  Watch(Watch&&) noexcept = default;
  Watch& operator=(Watch&& other) noexcept;
  ~Watch() { stop(); }

  /// Waits for these events from now on. @pre watching
  void set_events(std::uint32_t events);
  /// Calls back in the loop's next turn even if nothing comes; the others get their turn before. @pre watching
  void call_again();
  /// Packets have come this way: the loop may look here first, by a call with 0, before it asks the kernel what is
  /// ready. @pre watching
  void found_packets();
  /// No call after this, also not one that is due. May be called from within a call.
  void stop();

 private:
  friend class PacketLoop;
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace limb_ring::event_loop
