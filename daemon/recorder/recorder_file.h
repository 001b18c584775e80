#pragma once

#include <memory>
#include <string>
#include <vector>

#include "recorder/flight_recorder.h"

namespace limb_ring::recorder {

struct Unmap {
  std::size_t size;
  void operator()(std::uint8_t* memory) const;
};
using Mapping = std::unique_ptr<std::uint8_t, Unmap>;

/// A flight recorder whose memory is a file: what it has written is there after the process was killed. (ours)
class RecorderFile {
 public:
  /// The file of a former life goes on as `path` + ".former".
  /// @param size bytes of the file, at least FlightRecorder::kLeast
  /// @param on_too_small see FlightRecorder
  /// @throw std::system_error where it cannot be made
  RecorderFile(const std::string& path, std::size_t size, core::NetworkController& controller, const Title& title,
               core::Time now, std::function<void()> on_too_small);

  /// See FlightRecorder.
  void set_next(core::Journal* next) { recorder_.set_next(next); }

 private:
  Mapping memory_;
  FlightRecorder recorder_;
};

/// Where the node of that id records, in its ring's runtime folder.
std::string recording_of(const std::string& folder, unsigned id);

/// Recordings of a ring's nodes in its runtime folder, of their last lives and the ones before, also of dead ones:
/// "5.record", "5.record.former".
std::vector<std::string> recordings_in(const std::string& folder);

/// That recording is of the life before the last.
bool is_of_former_life(const std::string& recording);

/// Saves one of them, also while its node goes on. @return bytes saved
/// @throw std::exception says what is wrong
std::size_t save_file(const std::string& recording, const std::string& to);

}  // namespace limb_ring::recorder
