#pragma once

#include <vector>

#include "judge/record_layout.h"
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

/// The title of a recorder's memory, or of what save() has returned: their first kTitleSize bytes are enough.
/// @throw std::runtime_error where it is none, or was written by another version
Title read_title(wire::ByteView bytes);

/// What is to be kept of a recorder's memory, also while it goes on writing: title, used parts of the halves, and
/// behind them a CRC, so that a changed byte is found. (ours)
/// @throw std::runtime_error where it is no such memory, or is written faster than it can be read
std::vector<std::uint8_t> save(wire::ByteView memory);

/// @param saved what save() has returned, which must outlive the result
/// @throw std::runtime_error where it is none, or was changed since; says what is wrong
Recording read_saved(wire::ByteView saved);

}  // namespace limb_ring::recorder
