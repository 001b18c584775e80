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
  std::string words;                            ///< of the fault
  std::chrono::steady_clock::time_point since;  ///< this host's: it is one clock for all processes

  std::string name() const;  ///< the first word: "kill"
};

/// @return why it could not be written; empty: it is
std::string write_note(const std::string& folder, wire::NodeId node, const std::string& words);
void remove_note(const std::string& folder, wire::NodeId node);
std::optional<NodeNote> note_of(const std::string& folder, wire::NodeId node);

/// Records in ID.killed, in the ring's folder, the pid of the daemon that is killed on purpose. The file stays when the
/// node is started again, so that a program that looks only then does not report a crash. To be called before the
/// signal is sent. @return as write_note
std::string write_killed(const std::string& folder, wire::NodeId node, pid_t daemon);
/// Whether `daemon`, a pid, is the node's daemon that was last killed on purpose.
bool was_killed(const std::string& folder, wire::NodeId node, pid_t daemon);

}  // namespace limb_ring::live
