#pragma once

#include <boost/circular_buffer.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <vector>

#include "judge/percentiles.h"

namespace limb_ring::runtime {

/// The round trips of a node's sends and beacons of the last minute, 4096 at most. One pause of the machine is
/// forgotten after that time.
class RoundTrips {
 public:
  static constexpr std::size_t kKept = 4096;
  static constexpr core::Duration kWithin = std::chrono::seconds(60);

  void add(core::Time now, core::Duration round_trip) { last_.push_back({now, round_trip}); }

  /// statistics::to_json(), and "since_s": how long ago the first of them ended; null where there is none.
  nlohmann::json to_json(core::Time now) const {
    std::vector<core::Duration> lately;
    nlohmann::json since_s;
    for (const Ended& one : last_) {
      if (now - one.at > kWithin) continue;
      if (lately.empty()) since_s = std::chrono::duration<double>(now - one.at).count();
      lately.push_back(one.round_trip);
    }
    nlohmann::json all = statistics::to_json(statistics::percentiles(lately));
    all["since_s"] = since_s;
    return all;
  }

 private:
  struct Ended {
    core::Time at;
    core::Duration round_trip;
  };
  boost::circular_buffer<Ended> last_{kKept};
};

}  // namespace limb_ring::runtime
