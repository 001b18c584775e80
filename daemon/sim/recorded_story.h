#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <string>

#include "sim/recorded_window.h"
#include "sim/scenario_cause.h"

namespace limb_ring::sim {

/// What flight recorders have saved of a ring that broke a promise, as a story whose cause can be looked for.
struct RecordedStory {
  std::optional<promises::Breach> breach;    ///< the first that can be looked at; nothing: no promise was broken
  std::string node;                          ///< at which it was broken, by name
  std::string why_not;                       ///< why there is no story though a promise was broken
  std::chrono::nanoseconds broken_after{0};  ///< so long after the first record of all
  std::chrono::nanoseconds from{0};  ///< the story begins so long after that record; what was before is never left out
  std::unique_ptr<scenario::Story> story;  ///< null if none was found
};

/// Most events of a story.
constexpr std::size_t kMostRecordedEvents = 3000;

/// Finds the first broken promise, and the span before it that is enough to break it again: what came from outside into
/// the cores in that span are the events. Left out is an event by doing all exactly as it was recorded until just
/// before it; from there on the cores go on as a ring of their own (resumed_ring.h). In future 1 no fault comes any
/// more, and what was asked for is; in each further one every later event is left out with a probability of one half.
/// (ours)
/// @param folder of `ringctl record save` @param tell what is being done; throws to end it
/// @throw UnreadableRecording
RecordedStory story_of(const std::string& folder, const RecordedJudging& judging,
                       const std::function<void(const std::string&)>& tell);

/// The states of all nodes as a capture of events, for a picture. Its time 0 is `from`.
/// @param from,until after the first record
/// @throw UnreadableRecording
void capture_states(const std::string& folder, std::chrono::nanoseconds from, std::chrono::nanoseconds until,
                    std::ostream& out);

}  // namespace limb_ring::sim
