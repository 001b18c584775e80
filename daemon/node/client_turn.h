#pragma once

#include <algorithm>
#include <chrono>

#include "node/turn_keeper.h"

namespace limb_ring::host {

/// The turns of a client in lockstep. It acts while it has its turn, the ring's time stands meanwhile, and it gets its
/// messages when its next turn begins. Times are of the ring's clock.
class ClientTurn {
 public:
  explicit ClientTurn(TurnKeeper& keeper) : keeper_(keeper) {}

  void begin() {
    is_on_ = true;
    has_news_ = false;
  }
  /// @param until when it lets time pass, unless there is news
  void end(std::chrono::nanoseconds until) {
    is_on_ = false;
    is_awaited_ = true;
    next_ = until;
  }
  bool is_on() const { return is_on_; }

  /// A message is waiting that the client should get at once.
  void tell_news() {
    has_news_ = true;
    keeper_.has_news();
  }
  bool has_news() const { return has_news_; }
  /// The next turn begins so soon at the latest.
  void comes_within(std::chrono::nanoseconds time) { next_ = std::min(next_, keeper_.now() + time); }
  std::chrono::nanoseconds next() const { return next_; }

  /// Whether its messages are read only while somebody waits for them, so that clients acting in the same instant are
  /// heard in their order. It is so until it has taken too long, and again from the end of that turn.
  bool is_awaited() const { return is_awaited_; }
  void await_no_more() { is_awaited_ = false; }

 private:
  TurnKeeper& keeper_;
  bool is_on_ = false;
  bool has_news_ = false;
  bool is_awaited_ = true;
  std::chrono::nanoseconds next_ = std::chrono::nanoseconds::max();
};

}  // namespace limb_ring::host
