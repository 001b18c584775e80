#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "judge/record.h"
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
/// @throw std::runtime_error if it is none, or was written by another version
Title read_title(wire::ByteView bytes);

/// What is to be kept of a recorder's memory, also while it goes on writing: title, used parts of the halves, and
/// behind them a CRC, so that a changed byte is found. (ours)
/// @throw std::runtime_error if it is no such memory, or is written faster than it can be read
std::vector<std::uint8_t> save(wire::ByteView memory);

/// @param saved what save() has returned, which must outlive the result
/// @throw std::runtime_error if it is none, or was changed since; says what is wrong
Recording read_saved(wire::ByteView saved);

/// What save_ring() has copied.
struct SavedRing {
  std::size_t recordings = 0, bytes = 0;
  std::vector<std::string> problems;  ///< of those that could not be saved: which, and what is wrong
};

/// Copies the recordings of all nodes of a ring, also of dead ones and of the lives before, while the ring goes on.
/// @param ring_folder its runtime folder
/// @param to a folder, which is made if it is not there
/// @return 0 recordings if there are none
/// @throw std::exception if the folder cannot be made
SavedRing save_ring(const std::string& ring_folder, const std::string& to);

/// Removes the saves beside `newest`, the save that has just been made, until `keep` are left with it: the oldest
/// first. A save is a folder named `prefix` and a date (2026-11-23_...). How old it is says the time at which it was
/// last written, not its name: local time runs twice through an hour in October. One from the future counts as the
/// oldest, as it was made before the clock was set back.
/// @param keep at least 1
void remove_old_saves(const std::string& newest, const std::string& prefix, std::size_t keep);

}  // namespace limb_ring::recorder
