#pragma once

#include <string>
#include <vector>

#include "recorder/layout.h"
#include "wire/bytes.h"

namespace limb_ring::recorder {

/// What a flight recorder has left: the title, and its halves in order. Views into the bytes it was read from.
struct Recording {
  struct Half {
    std::uint64_t generation = 0;
    wire::ByteView bytes;  ///< time, state, records
  };
  Title title;
  std::vector<Half> halves;  ///< one or two that follow each other, the older one first
};

/// @param bytes a recorder's memory or file, which must outlive the result
/// @throw std::runtime_error where it is none, says what is wrong
Recording read_recording(wire::ByteView bytes);

/// A file that was saved: the recording, and behind it the CRC of all of it, so that a changed byte is found. (ours)
std::vector<std::uint8_t> seal(const std::vector<std::uint8_t>& recording);
/// @return the recording's bytes alone
/// @throw std::runtime_error where the CRC differs
wire::ByteView unseal(wire::ByteView saved);

}  // namespace limb_ring::recorder
