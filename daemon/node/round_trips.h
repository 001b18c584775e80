#pragma once

#include <boost/circular_buffer.hpp>
#include <vector>

#include "judge/percentiles.h"

namespace limb_ring::runtime {

/// The round trips of a node's last 4096 sends.
class RoundTrips {
 public:
  static constexpr std::size_t kKept = 4096;
  void add(core::Duration round_trip) { last_.push_back(round_trip); }
  statistics::Percentiles get() const {
    std::vector<core::Duration> copy(last_.begin(), last_.end());
    return statistics::percentiles(copy);
  }

 private:
  boost::circular_buffer<core::Duration> last_{kKept};
};

}  // namespace limb_ring::runtime
