#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>

#include "link/endpoint.h"

namespace limb_ring::link {

/// Calls from the event loop once per period: the one coarse timer of a link's end, so that no
/// packet arms a timer of its own. No call after stop() or destruction, also from within a call.
class Ticker {
 public:
  Ticker(boost::asio::io_context& io, milliseconds period, std::function<void(Time)> on_tick);
  ~Ticker() { stop(); }
  Ticker(const Ticker&) = delete;
  Ticker& operator=(const Ticker&) = delete;
  void stop();

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace limb_ring::link
