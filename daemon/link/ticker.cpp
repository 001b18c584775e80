#include "link/ticker.h"

#include <boost/asio/steady_timer.hpp>

namespace limb_ring::link {

struct Ticker::State : std::enable_shared_from_this<State> {
  State(boost::asio::io_context& io, milliseconds every, std::function<void(Time)> call)
      : timer(io), period(every), on_tick(std::move(call)) {}

  void wait() {
    timer.expires_after(period);
    timer.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
      if (!error && !self->stopped) self->tick();
    });
  }

  void tick() {
    on_tick(Clock::now());
    if (!stopped) wait();
  }

  boost::asio::steady_timer timer;
  milliseconds period;
  std::function<void(Time)> on_tick;
  bool stopped = false;
};

Ticker::Ticker(boost::asio::io_context& io, milliseconds period, std::function<void(Time)> on_tick)
    : state_(std::make_shared<State>(io, period, std::move(on_tick))) {
  state_->wait();
}

void Ticker::stop() {
  state_->stopped = true;
  state_->timer.cancel();
}

}  // namespace limb_ring::link
