#pragma once

#include <stdexcept>
#include <vector>

#include "study/comparison/network.h"

namespace limb_ring::study {

/// When each message was delivered, as Network::carry() returns it.
class Deliveries {
 public:
  Deliveries(std::size_t messages, Time until) : at_(messages, core::kNever), open_(messages), until_(until) {}

  /// @throw std::logic_error where that message was delivered before: the model is wrong
  void put(std::size_t message, Time at) {
    if (at_[message] != core::kNever) throw std::logic_error("a message was delivered twice");
    --open_;
    at_[message] = at;
  }
  /// Whether anything can still be delivered by `until`.
  bool go_on(Time now) const { return open_ > 0 && now <= until_; }
  /// By message; what was delivered after `until` counts as not delivered.
  std::vector<Time> result() const {
    std::vector<Time> out = at_;
    for (Time& at : out)
      if (at > until_) at = core::kNever;
    return out;
  }

 private:
  std::vector<Time> at_;
  std::size_t open_;
  Time until_;
};

}  // namespace limb_ring::study
