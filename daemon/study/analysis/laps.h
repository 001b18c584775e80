#pragma once

#include <vector>

#include "config/ring_config.h"
#include "study/analysis/streams.h"

namespace limb_ring::study {

/// Worst laps of the packets of a ring whose lines may differ (protocol.md section 7.2; the formulae
/// for lines that differ are ours). No losses, every receiver has room.
///
///   lap    = T + sum of d + what is ahead at each other node + I
///   ahead  at a node: one packet of its own, its largest, which starts just before ours arrives;
///          where the line out is slower than the line in, one packet of every other node
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

}  // namespace limb_ring::study
