#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>

#include "wire/packet.h"

namespace limb_ring::live {

/// What was done to a whole node from outside, and when: its daemon is dead or stopped and cannot keep it.
/// One file for a node, ID.fault in the ring's folder. (ours)
struct NodeNote {
  std::string words;  ///< of the fault
  std::chrono::system_clock::time_point since;

  std::string name() const;  ///< the first word: "kill"
};

/// @return why it could not be written; empty: it is
std::string write_note(const std::string& folder, wire::NodeId node, const std::string& words);
void remove_note(const std::string& folder, wire::NodeId node);
std::optional<NodeNote> note_of(const std::string& folder, wire::NodeId node);
/// Whether the node's note says that it was killed. Then nobody but `fault start` is to start its daemon again.
bool is_killed(const std::string& folder, wire::NodeId node);

/// Keeps who was killed on purpose, in ID.killed of the ring's folder; it stays when the node is started again, so that
/// who looks only then knows that this daemon has not crashed. Written before the signal. @return as write_note
std::string write_killed(const std::string& folder, wire::NodeId node, pid_t daemon);
/// Whether that daemon is the one of the node that was killed on purpose last.
bool was_killed(const std::string& folder, wire::NodeId node, pid_t daemon);

}  // namespace limb_ring::live
