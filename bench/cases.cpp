#include "bench/cases.h"

namespace limb_ring::bench {

void Cases::add(const std::string& what, Sending sending, const Measurement& measured, double reference_p50) {
  Case& all = cases_[{what, sending}];
  all.rounds.push_back(measured);
  all.ratios.push_back(measured.round_trip_us.p50 / reference_p50);
}

void Cases::add_without(const std::string& what, Sending sending, const Measurement& without) {
  Case& all = cases_.at({what, sending});
  all.additions.push_back(all.rounds.back().round_trip_us.p50 / without.round_trip_us.p50);
}

std::vector<Row> Cases::rows(Pinning pinning) const {
  std::vector<Row> rows;
  for (const auto& [key, measured] : cases_) {
    const double addition = measured.additions.empty() ? 0 : median(measured.additions);
    rows.push_back({key.first, pinning, key.second, of_rounds(measured.rounds), median(measured.ratios), addition});
  }
  return rows;
}

}  // namespace limb_ring::bench
