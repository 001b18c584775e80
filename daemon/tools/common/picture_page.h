#pragma once

#include <chrono>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "wire/pcapng.h"

/// Pictures as pages: one file of HTML with SVG inside, which loads nothing else, in both themes. (ours)

namespace limb_ring::app {

/// How long the messages of one stream took, in us.
struct StreamLatencies {
  std::string name;               ///< and from where to where
  std::vector<double> latencies;  ///< in any order
  std::optional<double> bound;    ///< the worst that was computed, or asked for
};

/// A histogram for each stream, with its bound as a line, and beside it the median, the 99th percentile and the
/// maximum. A stream without messages says so.
/// @param words what these are latencies of
void write_latencies(std::ostream& out, const std::string& title, const std::string& words,
                     const std::vector<StreamLatencies>& streams);

/// A line across all rows of a picture, with a short label below them.
struct TimeMark {
  std::chrono::nanoseconds at;
  std::string label, words;
};

/// A row for each node of a capture: its states as bars with their words, and what else happened to it as marks.
/// @param events as sim::RingCapture writes them: "joining -> up", "killed". @param lasted so long, from 0
/// @return SVG, for a page with the colours of web/style.css
std::string states_picture(const capture::RingNames& names, const std::vector<capture::CapturedEvent>& events,
                           std::chrono::nanoseconds lasted, const std::vector<TimeMark>& marks = {});

/// The same for a capture as a page. @param report in plain text, below it. @throw capture::CaptureFileError
void write_states(std::ostream& out, const std::string& title, std::istream& capture, const std::string& report,
                  std::chrono::nanoseconds lasted, const std::vector<TimeMark>& marks = {});

}  // namespace limb_ring::app
