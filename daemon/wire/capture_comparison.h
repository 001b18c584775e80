#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "wire/pcapng.h"

namespace limb_ring::capture {

/// How far two captures of a ring are the same, and where they part.
struct CaptureComparison {
  std::uint64_t equal = 0;  ///< packets and events that are the same in both, from the start
  /// What comes next if one differs; of the capture that ends there, nothing.
  std::optional<PcapngReader::Record> first, second;

  bool same() const { return !first && !second; }
};

/// Reads both up to where they part, or to their ends. @throw CaptureFileError
/// @param goes_on is called now and then with what is equal so far
CaptureComparison compare(PcapngReader& first, PcapngReader& second,
                          const std::function<void(std::uint64_t)>& goes_on = {});

/// "time, bytes from 8": what of them differs; empty if nothing does. @pre both are packets, or both events
std::string difference(const PcapngReader::Record& first, const PcapngReader::Record& second);

}  // namespace limb_ring::capture
