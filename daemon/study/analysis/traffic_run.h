#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/outcome.h"
#include "study/analysis/latency.h"
#include "study/analysis/plan.h"
#include "study/analysis/streams.h"

namespace limb_ring::study {

/// What became of one stream's messages.
struct StreamRun {
  std::size_t asked = 0;  ///< messages
  /// From the CPU's request for a message. A beacon's request is the NC's own and not to be seen: its
  /// `confirmed` counts from its first byte on the line, and `delivered` is empty.
  Latencies delivered;  ///< until its last packet's last bit is at the destination (a broadcast: the last one)
  Latencies confirmed;  ///< ... is home again
  std::array<std::size_t, wire::kOutcomes> outcomes{};  ///< packets (or interrupts) by core::Outcome

  std::size_t failed() const;  ///< packets that were not delivered
};

/// How long the streams of a plan are simulated, and how.
struct TrafficOptions {
  Duration duration{0};    ///< messages are asked for this long; then what is under way comes home
  std::uint64_t seed = 1;  ///< of the phases not given, and of jitter
  std::function<void(double)> tell = [](double) {};  ///< share done, now and then
};

/// Runs streams on the core under a virtual clock, with CPUs that read at once. Phases count from an
/// instant at which every node has joined. Messages of several packets are fed in as ring_bridge does:
/// at most 4 of a stream in the NC at a time.
/// @param ring every line has a rate @return as `streams`
std::vector<StreamRun> run_traffic(const config::RingConfig& ring, const std::vector<Stream>& streams,
                                   const TrafficOptions& options);

/// Whether a run kept the plan's promise: every message delivered, none later than its bound. Where there
/// is no bound, nothing was promised.
bool kept(const StreamPlan& plan, const StreamRun& run);

}  // namespace limb_ring::study
