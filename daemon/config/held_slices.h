#pragma once

#include <algorithm>
#include <deque>
#include <vector>

#include "core/time.h"
#include "wire/slice.h"

namespace limb_ring::fault {

using core::Duration;
using core::Time;

/// Slices that a line holds back, in order. (ours)
class HeldSlices {
 public:
  /// @param byte_time of the line: what was held back goes on no faster
  explicit HeldSlices(Duration byte_time) : byte_time_(byte_time) {}

  bool empty() const { return slices_.empty(); }
  std::size_t count() const { return slices_.size(); }
  /// With the framing.
  std::size_t bytes() const { return bytes_; }
  /// The last one that went on is through.
  bool line_free(Time now) const { return free_at_ <= now; }

  /// @param due when it may go on at the earliest; never before those that are held already
  void put(wire::SliceKind kind, wire::ByteView bytes, Time due) {
    slices_.push_back({due, kind, {bytes.begin(), bytes.end()}});
    bytes_ += size_of(slices_.back());
  }
  /// Nothing goes on before `time`.
  void block_until(Time time) { free_at_ = std::max(free_at_, time); }
  /// When the next one may go on, kNever if there is none. @param pace least time per byte, beside the line's own
  Time next(Duration pace) const {
    if (slices_.empty()) return core::kNever;
    const Held& first = slices_.front();
    const auto size = static_cast<std::int64_t>(first.bytes.size());
    // By its due time a slice has passed at the line's own pace; at a slower pace it only begins then.
    return std::max({first.due, free_at_ + byte_time_ * size, std::max(first.due, free_at_) + pace * size});
  }
  /// The next one goes on. @pre next(pace) is not in the future
  void take(Duration pace, wire::SliceWriter& out) {
    free_at_ = next(pace);
    const Held& first = slices_.front();
    out.put(first.kind, {first.bytes.data(), first.bytes.size()});
    bytes_ -= size_of(first);
    slices_.pop_front();
  }
  void clear() {
    slices_.clear();
    bytes_ = 0;
  }

 private:
  struct Held {
    Time due;
    wire::SliceKind kind;
    std::vector<std::uint8_t> bytes;
  };
  static std::size_t size_of(const Held& held) { return wire::kSliceHeaderSize + held.bytes.size(); }

  Duration byte_time_;
  Time free_at_{};
  std::deque<Held> slices_;
  std::size_t bytes_ = 0;
};

}  // namespace limb_ring::fault
