#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/response.h"

namespace limb_ring::study {

/// Worst case of one stream. Latencies count from the CPU's request for a message until its last
/// packet's last bit is in.
struct StreamPlan {
  std::optional<Duration> delivered;  ///< ... at the destination (a broadcast: the last one); none: no bound
  std::optional<Duration> confirmed;  ///< ... home again
  std::string why;                    ///< what the bound consists of, in words
  bool late = false;                  ///< that is beyond the stream's deadline
  double load = 0;                    ///< share of its source's time: rate times the worst laps of a message
};

/// What one node has to carry.
struct NodePlan {
  double data = 0;          ///< share of time in which a DATP of it is under way in the worst case; below 1
  double interrupts = 0;    ///< the same for its INTPs
  std::size_t waiting = 0;  ///< bytes in its insertion buffer at most
};

/// Whether a ring carries its streams, and how late each can be. Valid without losses, with queues and
/// receivers that always have room, and as long as nothing but these streams is sent.
struct Plan {
  std::vector<StreamPlan> streams;  ///< as those given
  std::vector<NodePlan> nodes;      ///< in ring order
  std::vector<double> lines;        ///< share of time in which the line out of each node is in use; below 1
  Duration longest_lap{0};          ///< of any DATP; must be below the time-out of a try
  std::vector<std::string> limits;  ///< why it cannot be carried, a sentence each; empty: it can

  bool carried() const { return limits.empty(); }
};

/// A node has one DATP outstanding, so a DATP holds its node for a lap (response.h); which goes next is decided
/// by priority, and what a message waits for by response.h. INTPs the same, first come first served.
/// A stream that may wait longer than `timeouts.queue`, after which the NC gives up, has no bound.
/// @param ring every line has a rate
Plan plan(const config::RingConfig& ring, const std::vector<Stream>& streams);

/// The outcome in plain words, a sentence or a few.
std::string verdict(const config::RingConfig& ring, const Plan& plan);

/// What a bound consists of: "own + 2 of higher or same priority + 1 ahead (4.192 us), laps of up to 75.264 us".
std::string in_words(const Response& response, Duration ahead, Duration longest_lap);

/// What keeps the ring from carrying its streams, a sentence each: a node or a line with too much to do,
/// a buffer that is too small, a time-out that is too short, a stream that may wait too long.
std::vector<std::string> limits_of(const config::RingConfig& ring, const std::vector<Stream>& streams,
                                   const Plan& plan);

}  // namespace limb_ring::study
