#include "io/watch.h"

#include <sys/epoll.h>

#include "io/watch_state.h"

namespace limb_ring::event_loop {

Watch::Watch(boost::asio::io_context& io, int fd, std::uint32_t events, OnReady on_ready, Trigger trigger)
    : state_(std::make_shared<State>()) {
  state_->fd = fd;
  state_->trigger = trigger;
  state_->events = events;
  state_->on_ready = std::move(on_ready);
  PacketLoop::of(io).add(state_);
}

Watch& Watch::operator=(Watch&& other) noexcept {
  if (this != &other) stop();
  state_ = std::move(other.state_);
  return *this;
}

void Watch::set_events(std::uint32_t events) {
  if (state_->events == events) return;
  state_->events = events;
  state_->loop->change(state_, EPOLL_CTL_MOD);
}

void Watch::call_again() {
  if (std::exchange(state_->again, true)) return;
  state_->loop->call_later(state_);
}

void Watch::found_packets() { state_->loop->found_packets(*state_); }

void Watch::stop() {
  if (!state_ || state_->loop == nullptr) return;
  state_->loop->remove(std::move(state_));
}

}  // namespace limb_ring::event_loop
