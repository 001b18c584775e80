#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace limb_ring::recorder {

/// What save_ring() has copied.
struct SavedRing {
  std::size_t recordings = 0, bytes = 0;
  std::vector<std::string> problems;  ///< of those that could not be saved: which, and what is wrong
};

/// Copies the recordings of all nodes of a ring, also of dead ones and of the lives before, while the ring goes on.
/// @param ring_folder its runtime folder
/// @param to a folder, which is made where it is not there
/// @return 0 recordings where there are none
/// @throw std::exception where the folder cannot be made
SavedRing save_ring(const std::string& ring_folder, const std::string& to);

/// Removes the saves beside `newest`, the save that has just been made, until `keep` are left with it: the oldest
/// first. A save is a folder named `prefix` and a date (2026-11-23_...). How old it is says the time at which it was
/// last written, not its name: local time runs twice through an hour in October. One from the future counts as the
/// oldest, as it was made before the clock was set back.
/// @param keep at least 1
void remove_old_saves(const std::string& newest, const std::string& prefix, std::size_t keep);

}  // namespace limb_ring::recorder
