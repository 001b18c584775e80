#include "tools/ringctl/line_delays.h"

#include <algorithm>

namespace limb_ring::ringctl {

namespace {

/// Nothing arrives before it was sent: what is below 0 says by how much the latches are wrong.
void clamp(double& us, double& uncertain_us) {
  uncertain_us = std::max(uncertain_us, -us);
  us = std::max(us, 0.0);
}

}  // namespace

LineDelays line_delays(const std::vector<std::optional<std::int64_t>>& latches_ns,
                       const std::vector<std::string>& hosts, std::size_t source, double round_trip_us) {
  LineDelays all;
  all.between_hosts_us = round_trip_us;
  std::size_t from = source;
  for (std::size_t step = 1; step <= latches_ns.size(); ++step) {
    const std::size_t to = (source + step) % latches_ns.size();
    if (!latches_ns[to]) continue;
    LineDelay line{from, to, std::nullopt};
    if (hosts[from] == hosts[to]) {
      const double home_us = to == source ? round_trip_us : 0;  // it has latched when the interrupt left
      line.us = static_cast<double>(*latches_ns[to] - *latches_ns[from]) / 1000.0 + home_us;
      all.between_hosts_us -= *line.us;
      clamp(*line.us, all.uncertain_us);
    } else {
      ++all.between_hosts;
    }
    all.lines.push_back(line);
    from = to;
  }
  if (all.between_hosts == 0) all.between_hosts_us = 0;
  clamp(all.between_hosts_us, all.uncertain_us);
  return all;
}

}  // namespace limb_ring::ringctl
