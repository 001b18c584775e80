#include "study/analysis/case_ring.h"

#include "study/analysis/model_ring.h"

namespace limb_ring::study {

namespace {

// Nothing is lost in a case, so nothing is to be sent again. Where packets are long beside the relay delay, INTPs take
// so much of the lines that a DATP needs longer than two worst laps, which have one INTP for each node.
sim::VirtualRingOptions without_time_outs(const Medium& medium) {
  sim::VirtualRingOptions options = ring_options(medium);
  options.adjust = [usual = options.adjust](core::Settings& settings) {
    usual(settings);
    settings.send_timeout_least = settings.queue_timeout;
  };
  return options;
}

}  // namespace

CaseRing::CaseRing(const Medium& medium, std::ostream* trace)
    : sim::WatchedRing(without_time_outs(medium)), medium_(medium), trace_(*this, trace), line_use_(*this) {
  join_and_settle(*this, medium);
  zero_ = now();
}

double CaseRing::occupancy(Time since, std::uint64_t bytes) const {
  const auto used = medium_.byte_time() * static_cast<std::int64_t>(line_use_.bytes() - bytes);
  const auto all = (now() - since) * static_cast<std::int64_t>(medium_.nodes);
  return all.count() == 0 ? 0 : static_cast<double>(used.count()) / static_cast<double>(all.count());
}

}  // namespace limb_ring::study
