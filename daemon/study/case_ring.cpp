#include "study/case_ring.h"

namespace limb_ring::study {
namespace {

sim::VirtualRingOptions options_of(const Medium& medium) {
  sim::VirtualRingOptions options;
  options.nodes = medium.nodes;
  options.byte_time = medium.byte_time();
  options.relay_delay = medium.relay_delay;
  options.keep_logs = false;
  options.adjust = [](core::Settings& settings) {
    settings.beacon = Duration{0};
    settings.send_timeout_least = Duration{0};
    settings.queue_timeout = std::chrono::hours(1);  // of laps at 1 kbit/s
    settings.stall = std::chrono::hours(1);
  };
  return options;
}

}  // namespace

CaseRing::CaseRing(const Medium& medium, std::ostream* trace)
    : sim::WatchedRing(options_of(medium)), medium_(medium), trace_(*this, trace), line_use_(*this) {
  const core::Settings& any = settings(0);
  const auto joined = [this] {
    for (unsigned id = 0; id < size(); ++id)
      if (!node(static_cast<NodeId>(id)).membership().accepts_sends()) return false;
    return true;
  };
  if (!run_until(joined, 10 * any.worst_lap())) throw std::runtime_error("the virtual ring did not join");
  run_for(2 * any.worst_lap());
  zero_ = now();
}

double CaseRing::occupancy(Time since, std::uint64_t bytes) const {
  const auto used = medium_.byte_time() * static_cast<std::int64_t>(line_use_.bytes() - bytes);
  const auto all = (now() - since) * static_cast<std::int64_t>(medium_.nodes);
  return all.count() == 0 ? 0 : static_cast<double>(used.count()) / static_cast<double>(all.count());
}

}  // namespace limb_ring::study
