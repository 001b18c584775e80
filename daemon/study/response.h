#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "core/time.h"
#include "wire/packet.h"

namespace limb_ring::study {

using core::Duration;
using wire::NodeId;

/// Messages (or interrupts) that one node asks for again and again.
struct Stream {
  std::string name;
  NodeId source{0};                       ///< place in ring order, from 0; as is the destination
  NodeId destination{0};                  ///< or wire::kBroadcast
  std::uint8_t priority = 0;              ///< 0 (highest) to 3; means nothing for an interrupt
  bool beacon = false;                    ///< the NC's own: goes before priority 0
  unsigned bytes = 0;                     ///< of one message; 0 for an interrupt
  std::vector<unsigned> packets;          ///< bytes of data of each DATP of a message; empty for an interrupt
  std::optional<std::uint8_t> interrupt;  ///< factor 0 to 7
  Duration period{0};
  Duration jitter{0};             ///< asked for up to so much later than the period says
  Duration deadline{0};           ///< delivered later than so long after it was asked for, it is late; 0: its period
  std::optional<Duration> phase;  ///< first message so long after the start; none: any

  Duration late_after() const { return deadline == Duration{0} ? period : deadline; }
  double rate() const { return 1e12 / static_cast<double>(period.count()); }  ///< Hz
};

/// Every stream that a ring's file implies (ours), in this order:
///   joint states    of each node with joints, to config::body_of() (firmware)
///   joint commands  from there to each of them, position and velocity of every joint (ring_bridge)
///   sensors         to there (firmware)
///   topics          that have a size and a rate (ring_bridge); the announcement before the first is not counted
///   traffic
///   beacons         of every network controller
std::vector<Stream> streams_of(const config::RingConfig& ring);

/// Worst laps of the packets of a ring whose lines may differ (protocol.md section 7.2; the formulae
/// for lines that differ are ours). No losses, every receiver has room.
///
///   lap    = T + sum of d + what is ahead at each other node + I
///   ahead  at a node: one packet of its own, its largest, which starts just before ours arrives;
///          if the line out is slower than the line in, one packet of every other node
///   T      of the packet, on the slowest line it passes; on equal lines N (T + d) comes out
///   I      96 ns (at 1 Gbit/s) for each INTP that can be under way meanwhile: each overtakes once
///
/// An INTP waits at each node for an INTP, and for the end of a DATP: odd bytes, trailer, CRC.
class Laps {
 public:
  /// @param ring every link has a rate. Places in `streams` are those of its nodes.
  Laps(const config::RingConfig& ring, const std::vector<Stream>& streams);

  /// From the first byte out until the tail is in at `to`; to == source: home.
  Duration data(NodeId source, NodeId to, unsigned bytes) const;
  /// The longest lap of any DATP.
  Duration longest_data() const;
  /// How long, at most, a packet of an idle node waits for one that passes.
  Duration data_ahead(NodeId source) const;
  /// Bytes that may be in a node's insertion buffer at a time: of each other node one DATP at most, and no more than
  /// come in while an own packet goes out, beside one half in and one half out.
  std::size_t waiting(NodeId node) const;
  Duration interrupt(NodeId source, NodeId to) const;
  Duration interrupt_ahead() const;

  /// INTPs that come once in a period, and are on the ring or waiting for it for up to `under_way`.
  struct Interrupts {
    Duration period{0}, under_way{0};
  };
  /// Sets the INTPs that delay the ring's DATPs; until it is called, there are none.
  /// @return false if they leave no room for a DATP
  bool set_interrupts(const std::vector<Interrupts>& interrupts);
  /// The shortest round trip of an INTP of this node, and so the shortest time between two of them.
  Duration least_interrupt() const;

  /// Of so many bytes on the line out of a node.
  Duration on_line(NodeId node, unsigned bytes) const { return byte_time_[node] * static_cast<std::int64_t>(bytes); }
  NodeId next(NodeId node) const { return static_cast<NodeId>((node + 1u) % byte_time_.size()); }
  NodeId previous(NodeId node) const { return static_cast<NodeId>((node + byte_time_.size() - 1) % byte_time_.size()); }

 private:
  template <class Visit>
  void visit_lines(NodeId source, NodeId to, Visit visit) const;
  bool narrows(NodeId node) const;
  Duration slowest_line(unsigned bytes) const;
  Duration all_but(NodeId source, NodeId line) const;
  Duration data_queue(NodeId source, NodeId node) const;
  Duration interrupt_queue(NodeId source, NodeId node) const;
  std::vector<Duration> byte_time_;  ///< of the line out of each node
  std::vector<Duration> delay_;      ///< d at its end
  std::vector<unsigned> largest_;    ///< bytes of each node's largest DATP on the line; 0: it sends none
  std::vector<unsigned> smallest_;   ///< ... and of its smallest
  unsigned odd_ = 0;                 ///< most bytes of data beyond whole words in any DATP
  Duration interrupts_{0};           ///< I
};

/// One stream as seen by the unit of Transmit that sends it: a message is `jobs` packets asked for
/// at once; each packet holds the unit for a lap.
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
/// @return nothing if the wait has no bound below `limit`
std::optional<Response> worst_response(const std::vector<Contender>& contenders, std::size_t which, Duration ahead,
                                       Duration limit);

}  // namespace limb_ring::study
