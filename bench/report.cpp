#include "bench/report.h"

#include <algorithm>
#include <numeric>

namespace limb_ring::bench {

const Row* Report::find(const std::string& what, Pinning pinning, Sending sending) const {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& row) {
    return row.what == what && row.pinning == pinning && row.sending == sending;
  });
  return found == rows.end() ? nullptr : &*found;
}

std::uint64_t Report::failed() const {
  return std::accumulate(rows.begin(), rows.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const Row& row) { return sum + row.measured.failed; });
}

}  // namespace limb_ring::bench
