#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "judge/percentiles.h"
#include "limb_ring/host_port.h"

namespace limb_ring::ringctl {

/// How all the packets of a ping ended. Takes no more memory the longer it goes on.
class PingTotals {
 public:
  /// Round trips for p50 and p99: those of the last packets, as many as a count can be.
  static constexpr std::size_t kKept = 1'000'000;

  std::uint64_t sent = 0;
  std::chrono::nanoseconds took{0};
  std::string problem;  ///< why there was an early end: the daemon has gone. Empty: there was none

  void add(const Result& result);
  std::uint64_t with(Outcome outcome) const;
  std::uint64_t ended() const;
  /// Of the delivered ones: all, but for p50 and p99.
  statistics::Percentiles round_trips() const;
  bool all_are_kept() const { return with(Outcome::delivered) <= kKept; }

 private:
  std::map<Outcome, std::uint64_t> ended_;
  std::vector<std::chrono::nanoseconds> kept_;
  std::chrono::nanoseconds least_ = std::chrono::nanoseconds::max(), most_{0};
};

}  // namespace limb_ring::ringctl
