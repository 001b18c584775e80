#include "study/analysis/case_ring.h"

#include "study/analysis/model_ring.h"

namespace limb_ring::study {

CaseRing::CaseRing(const Medium& medium, std::ostream* trace)
    : sim::WatchedRing(ring_options(medium)), medium_(medium), trace_(*this, trace), line_use_(*this) {
  join_and_settle(*this, medium);
  zero_ = now();
}

double CaseRing::occupancy(Time since, std::uint64_t bytes) const {
  const auto used = medium_.byte_time() * static_cast<std::int64_t>(line_use_.bytes() - bytes);
  const auto all = (now() - since) * static_cast<std::int64_t>(medium_.nodes);
  return all.count() == 0 ? 0 : static_cast<double>(used.count()) / static_cast<double>(all.count());
}

}  // namespace limb_ring::study
