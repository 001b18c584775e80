#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "core/outcome.h"
#include "study/model_ring.h"
#include "study/plan.h"
#include "study/response.h"

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

/// Whether a run kept the plan's promise: every message delivered, none later than its bound. If there
/// is no bound, nothing was promised.
bool kept(const StreamPlan& plan, const StreamRun& run);

/// What the losses that a ring's file expects of its lines do to it. A line loses each datagram by itself, with the
/// same probability; a packet that is lost anywhere on its lap is tried again, up to three times (protocol.md
/// section 4.3).
struct ExpectedLosses {
  double home = 1;       ///< probability that a packet comes home at its first try
  double delivered = 1;  ///< ... at one of its four
  double tries = 1;      ///< on average
  Duration timeout{0};   ///< of a try: so much later comes each further one
};

/// @return nothing if no line is expected to lose anything
std::optional<ExpectedLosses> expected_losses(const config::RingConfig& ring);

/// Seconds, on average, until a line falls silent though it is whole: all signs of life within `timeouts.silence` are
/// lost. Infinite if the line loses nothing.
double seconds_to_false_silence(const config::Timeouts& timeouts, double loss);

/// The shortest silence, a whole number of `timeouts.idle`, with which a line like this is taken for broken less than
/// once in a day.
config::milliseconds advised_silence(const config::Timeouts& timeouts, double loss);

/// Time-outs that are too short for what is expected of the lines, a sentence each.
std::vector<std::string> short_timeouts(const config::RingConfig& ring);

/// All of this for people; empty if nothing is expected of any line.
std::string expected_words(const config::RingConfig& ring);

}  // namespace limb_ring::study
