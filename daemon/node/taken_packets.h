#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

namespace limb_ring::program_stage {

/// What a CPU has taken of what its node has given to it. A CPU says so by its credit: the first is what it likes to
/// have, and each packet it has taken is one more. (docs/reference/host_port.md)
class TakenPackets {
 public:
  /// Of a scenario; nothing: a packet of no send.
  using Send = std::optional<std::size_t>;

  void given(Send send) { given_.push_back(send); }
  /// Calls `taken` for each packet of a scenario that has been taken by now.
  template <class Taken>
  void credited(unsigned packets, Taken taken) {
    if (!std::exchange(greeted_, true)) return;
    for (; packets != 0 && !given_.empty(); --packets) {
      if (given_.front()) taken(*given_.front());
      given_.pop_front();
    }
  }
  /// Another CPU takes its place.
  void clear() {
    given_.clear();
    greeted_ = false;
  }

 private:
  std::deque<Send> given_;
  bool greeted_ = false;  ///< the first credit is in
};

}  // namespace limb_ring::program_stage
