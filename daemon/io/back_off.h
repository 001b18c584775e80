#pragma once

#include <chrono>

namespace limb_ring::process {

/// How long to wait before a child that ended is started again: `first`, doubling up to `most`,
/// and `first` again once it has run for `steady`. (ours)
class BackOff {
 public:
  using milliseconds = std::chrono::milliseconds;
  struct Limits {
    milliseconds first{100};
    milliseconds most{5000};
    milliseconds steady{10000};
  };

  explicit BackOff(const Limits& limits) : limits_(limits), next_(limits.first) {}

  /// The wait after a child that ran for `ran`.
  milliseconds after(milliseconds ran);
  void reset() { next_ = limits_.first; }

 private:
  Limits limits_;
  milliseconds next_;
};

}  // namespace limb_ring::process
