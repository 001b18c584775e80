#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/measurement.h"
#include "bench/report.h"
#include "bench/setup.h"

namespace limb_ring::bench {

/// What each case has given, round by round, at one pinning.
class Cases {
 public:
  /// @param reference_p50 of the same round
  void add(const std::string& what, Sending sending, const Measurement& measured, double reference_p50);
  /// Of a case that is a ring with something in addition: the same ring of the same round without that.
  void add_without(const std::string& what, Sending sending, const Measurement& without);
  /// One for each case, of all its rounds.
  std::vector<Row> rows(Pinning pinning) const;

 private:
  struct Case {
    std::vector<Measurement> rounds;
    std::vector<double> ratios;
    std::vector<double> additions;
  };
  std::map<std::pair<std::string, Sending>, Case> cases_;
};

}  // namespace limb_ring::bench
