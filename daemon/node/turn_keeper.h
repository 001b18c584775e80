#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace limb_ring::host {

class Session;

/// Keeps the virtual clock for the clients of a host port that run in lockstep with it.
class TurnKeeper {
 public:
  virtual ~TurnKeeper() = default;
  /// Of the ring's clock.
  virtual std::chrono::nanoseconds now() const = 0;
  /// The CPU of a node has greeted. `attach` is called once, now or when its boot is over in the ring's time.
  virtual void greeted(std::uint8_t node, std::function<void()> attach) = 0;
  /// The CPU that has greeted is gone, and was not attached.
  virtual void left(std::uint8_t node) = 0;
  /// That CPU is attached, and waits for its first turn.
  virtual void joined(std::uint8_t node, const std::shared_ptr<Session>& session) = 0;
  /// Something is there for a client in lockstep.
  virtual void has_news() = 0;
  /// A client that the clock does not wait for has changed something.
  virtual void disturbed() = 0;
  /// The CPU of a node can take `packets` more packets: the first time its whole window, later as many as it has taken.
  virtual void credited(std::uint8_t /*node*/, unsigned /*packets*/) {}
  /// What the CPU of a node does that keeps time from going on, as a sentence without the node; empty: nothing.
  virtual std::string holds_time(std::uint8_t /*node*/) const { return ""; }
};

}  // namespace limb_ring::host
