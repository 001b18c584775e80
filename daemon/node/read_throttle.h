#pragma once

#include "core/time.h"

namespace limb_ring::runtime {

/// How fast a node's CPU is given what waits for it. (ours: a CPU made slow on purpose)
class ReadThrottle {
 public:
  /// No limit: the default.
  void as_fast_as_it_can() { period_ = core::Duration{0}; }
  /// One packet per `period`, the first at once.
  void one_per(core::Duration period) { period_ = period; }
  void not_at_all() { period_ = kNeverAgain; }

  bool may_take(core::Time now) const {
    if (period_.count() == 0) return true;
    return period_ != kNeverAgain && now >= last_ + period_;
  }
  void took(core::Time now) { last_ = now; }
  /// When it may take the next one; kNever where it may at once, or never.
  core::Time next() const { return period_.count() == 0 || period_ == kNeverAgain ? core::kNever : last_ + period_; }

 private:
  static constexpr core::Duration kNeverAgain = core::Duration::max();
  core::Duration period_{0};
  core::Time last_{};
};

}  // namespace limb_ring::runtime
