#pragma once

#include <string>
#include <vector>

#include "io/mapped_file.h"
#include "judge/flight_recorder.h"

namespace limb_ring::recorder {

/// A flight recorder whose memory is a file: what it has written is there after the process was killed. (ours)
class RecorderFile {
 public:
  /// An existing file, of the node's previous life, is renamed to `path` + ".former"; where this throws, it stays.
  /// @param size bytes of the file, at least FlightRecorder::kLeast
  /// @param on_too_small see FlightRecorder
  /// @throw std::system_error where it cannot be made
  RecorderFile(const std::string& path, std::size_t size, core::NetworkController& controller, const Title& title,
               core::Time now, std::function<void()> on_too_small);

  /// See FlightRecorder.
  void set_next(core::Journal* next) { recorder_.set_next(next); }
  /// False where it was removed from its folder, or cut off: what is recorded is lost.
  bool is_in_place() const;

 private:
  std::string path_;
  process::MappedFile memory_;
  FlightRecorder recorder_;
};

/// Where the node of that id records, in its ring's runtime folder.
std::string recording_of(const std::string& folder, unsigned id);

/// Names of the recordings in a ring's runtime folder, also of dead nodes: of each node's last life and the one before
/// it, "5.record" and "5.record.former".
std::vector<std::string> recordings_in(const std::string& folder);

/// That recording is of the life before the last.
bool is_of_former_life(const std::string& recording);

/// Saves one of them, also while its node goes on. @return bytes saved
/// @throw std::exception says what is wrong
std::size_t save_file(const std::string& recording, const std::string& to);

}  // namespace limb_ring::recorder
