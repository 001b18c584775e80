#include "node/virtual_pace.h"

#include <algorithm>
#include <cmath>

namespace limb_ring::virtual_host {

using std::chrono::nanoseconds;

namespace {

core::Duration scaled(nanoseconds real, double factor) {
  return core::Duration(static_cast<core::Int128>(static_cast<double>(real.count()) * factor * 1000));
}

}  // namespace

void Pace::set_factor(double factor, Real now, core::Time reached) {
  factor_ = factor;
  restart(now, reached);
}

void Pace::restart(Real now, core::Time reached) {
  real_ = now;
  virtual_ = reached;
}

core::Time Pace::allowed(Real now, core::Time reached) {
  if (std::isinf(factor_)) return core::kNever;
  const Real due = when(reached);
  if (now - due > kMostBehind) {
    lost_ += now - due - kMostBehind;
    real_ = now - kMostBehind;
    virtual_ = reached;
  }
  return virtual_ + scaled(now - real_, factor_);
}

nanoseconds Pace::late(Real now, core::Time reached) const {
  if (std::isinf(factor_)) return nanoseconds{0};
  return std::max(nanoseconds{0}, nanoseconds(now - when(reached)));
}

Pace::Real Pace::when(core::Time time) const {
  if (std::isinf(factor_)) return Real::min();
  constexpr double kLongest = 1e18;  // ns, 31 years
  const double ns = static_cast<double>((time - virtual_).count()) / 1000 / factor_;
  return real_ + nanoseconds(static_cast<std::int64_t>(std::min(std::ceil(ns), kLongest)));
}

}  // namespace limb_ring::virtual_host
