#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/time.h"

namespace limb_ring::study {

using core::Duration;

/// One stream as seen by the unit of Transmit that sends it: a message is `jobs` packets asked for
/// at once, each of which holds the unit for a lap.
struct Contender {
  unsigned rank = 0;    ///< smaller goes first
  unsigned jobs = 1;    ///< packets in a message
  Duration work{0};     ///< laps of all its packets
  Duration longest{0};  ///< the longest of them
  Duration last{0};     ///< that of its last packet
  Duration period{0};
  Duration jitter{0};

  double load() const { return static_cast<double>(work.count()) / static_cast<double>(period.count()); }
};

/// Worst case of one message, and what it is made of.
struct Response {
  Duration wait{0};        ///< from the request until the message's last packet starts
  std::size_t own = 0;     ///< packets of this stream, its last one too
  std::size_t others = 0;  ///< packets of higher and of the same priority that go first
  bool lower = false;      ///< a packet of lower priority is under way; else one on the line is ahead
};

/// Response-time analysis for fixed priorities without preemption, release jitter and messages of
/// several packets: R. I. Davis, A. Burns, R. J. Bril, J. J. Lukkien, "Controller Area Network (CAN)
/// schedulability analysis: Refuted, revisited and revised", Real-Time Systems 35, 2007. With C the
/// lap of a packet in place of a frame's time on the bus:
///
///   n_k(t) = floor((t + J_k) / P_k) + 1        messages of stream k asked for from 0 to t
///   w(q)   = B + (q + 1) E - C_last + sum over the others of the same or higher priority of E_k n_k(w(q))
///   wait   = max over q = 0 .. n(busy) - 1 of w(q) - max(0, q P - J)
///   busy   = B + sum over the same or higher priority, this one too, of E_k n_k(busy)
///
///   E  all laps of one message        P, J  period and jitter
///   B  what is under way already: the longest lap of a lower priority, else `ahead`
///   w, busy  the least solutions; busy is how long this priority can keep the unit busy
///
/// Within a priority everything that comes until the last packet starts is counted, not only what
/// came before the request: large messages are fed in packet by packet and so interleave. (ours)
/// @param ahead of a unit that was idle: until the line is its own
/// @return nothing where the wait has no bound below `limit`
std::optional<Response> worst_response(const std::vector<Contender>& contenders, std::size_t which, Duration ahead,
                                       Duration limit);

}  // namespace limb_ring::study
