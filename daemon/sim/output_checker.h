#pragma once

#include <vector>

#include "judge/packet_collector.h"
#include "sim/ring_record.h"

namespace limb_ring::sim {

/// Judges what leaves the nodes of a ring: own packets against what their CPUs have asked for, those of others against
/// what has come in, and none goes round twice. (protocol.md sections 2.2, 2.4 and 4.8)
class OutputChecker {
 public:
  explicit OutputChecker(RingRecord& record);

  void leaves(NodeId node, const wire::Slice& slice, Time now);
  template <class Archive>
  void archive(Archive& a) {
    a("outgoing", outgoing_);
  }

 private:
  /// The DATP that is on its way out of a node.
  struct Outgoing {
    PacketCollector collector{core::Duration::max()};
    bool own = false;
    PacketHeader header;
    Time since{};

    template <class Archive>
    void archive(Archive& a) {
      a("collector", collector)("own", own)("header", header)("since", since);
    }
  };

  void check_header(NodeId node, const PacketHeader& header);
  void check_source(NodeId node, const PacketHeader& header, Time now);
  void begins_to_leave(NodeId node, const wire::Slice& slice, Time now);
  void hello_begins(NodeRecord& n, Time now);
  void data_leaves(NodeId node, const wire::Slice& end, wire::ByteView own, Time now);
  void own_data_leaves(NodeId node, const wire::PacketFields& packet);
  void interrupt_leaves(NodeId node, const wire::Slice& slice, Time now);

  RingRecord& record_;
  std::vector<Outgoing> outgoing_;
};

}  // namespace limb_ring::sim
