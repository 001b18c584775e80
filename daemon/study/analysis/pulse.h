#pragma once

#include <cstdint>
#include <functional>

#include "sim/virtual_ring.h"
#include "study/analysis/medium.h"

namespace limb_ring::study {

/// Tells now and then that a ring goes on: every 4096 slices.
class Pulse : public sim::Observer {
 public:
  Pulse(sim::VirtualRing& ring, const std::function<void()>& goes_on) : goes_on_(goes_on) { ring.add_observer(*this); }
  void leaves(NodeId, const wire::Slice&, Time) override {
    if (++slices_ % 4096 == 0) goes_on_();
  }

 private:
  const std::function<void()>& goes_on_;
  std::uint64_t slices_ = 0;
};

}  // namespace limb_ring::study
