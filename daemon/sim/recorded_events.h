#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/recorded_window.h"

namespace limb_ring::sim {

/// A slice that came in place of one that was lost: changed, or late.
struct CameInstead {
  std::size_t departure = 0, call = 0;
};

/// One thing that happened to a recorded ring from outside its cores, and can be left out.
struct RecordedEvent {
  std::size_t first = 0;  ///< the first call that it shows in
  core::Time at{};
  std::string words;
  bool is_fault = false;                        ///< not something that a CPU or a client has asked for
  std::vector<std::size_t> calls;               ///< done again at their times
  std::vector<std::size_t> lost;                ///< departures that do not come in
  std::vector<CameInstead> instead;             ///< of `lost`, so much later as they were
  std::optional<RecordedWindow::Pause> pause;   ///< of a core
  std::optional<RecordedWindow::Pause> unread;  ///< of a CPU
};

/// All that came from outside into the recorded cores. (ours)
struct RecordedEvents {
  std::vector<RecordedEvent> events;  ///< by RecordedEvent::first
  std::vector<std::size_t>
      background;  ///< calls that are never left out: what CPUs report again and again, and what was under way
};

/// What happens to lines one after the other, less than Settings::break_grace apart, and with a node in common, is one
/// event with what it lost; what is lost on a line in a row is one, too; all else is an event of its own.
/// @param until what begins later is left away
RecordedEvents events_of(const RecordedWindow& window, core::Time until);

}  // namespace limb_ring::sim
