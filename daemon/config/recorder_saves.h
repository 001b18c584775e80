#pragma once

#include <string>
#include <vector>

namespace limb_ring::config {

/// When the recordings of a ring are saved by themselves: for `ringctl up`, the daemons do not need it. (ours)
struct RecorderSaves {
  std::vector<std::string> when;  ///< of "crash", "break", "promise"; empty: never
  std::string folder;             ///< absolute; each save is a folder in it
  unsigned keep = 5;              ///< so many saves of a ring, the newest
};

/// The entries `recorder.save`, `folder` and `keep` of a ring's file.
/// @param records whether its nodes record
/// @throw ConfigError, also where something is to be saved and nothing is recorded
RecorderSaves load_recorder_saves(const std::string& path, bool records);

}  // namespace limb_ring::config
