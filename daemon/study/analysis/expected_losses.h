#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "study/analysis/medium.h"

namespace limb_ring::study {

/// What the losses that a ring's file expects of its lines do to it. A line loses each datagram by itself, with the
/// same probability; a packet that is lost anywhere on its lap is tried again, up to three times (protocol.md
/// section 4.3).
struct ExpectedLosses {
  double home = 1;       ///< probability that a packet comes home at its first try
  double delivered = 1;  ///< ... at one of its four
  double tries = 1;      ///< on average
  Duration timeout{0};   ///< of a try: so much later comes each further one
};

/// @return nothing where no line is expected to lose anything
std::optional<ExpectedLosses> expected_losses(const config::RingConfig& ring);

/// Seconds, on average, until a line falls silent though it is whole: all signs of life within `timeouts.silence` are
/// lost. Infinite where the line loses nothing.
double seconds_to_false_silence(const config::Timeouts& timeouts, double loss);

/// The shortest silence, a whole number of `timeouts.idle`, with which a line like this is taken for broken less than
/// once in a day.
config::milliseconds advised_silence(const config::Timeouts& timeouts, double loss);

/// Time-outs that are too short for what is expected of the lines, a sentence each.
std::vector<std::string> short_timeouts(const config::RingConfig& ring);

/// All of this for people; empty where nothing is expected of any line.
std::string expected_words(const config::RingConfig& ring);

}  // namespace limb_ring::study
