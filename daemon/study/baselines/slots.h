#pragma once

#include <deque>
#include <vector>

#include "study/baselines/deliveries.h"
#include "study/baselines/send_queues.h"

namespace limb_ring::study {

/// The slots of EtherCAT's process image, one per node: what its node has put in travels on to
/// the nodes behind it; what the master has repeated travels as far as its node.
class Slots {
 public:
  /// @param bytes of a slot. All references must outlive this.
  Slots(const Medium& medium, const std::vector<Message>& messages, SendQueues::Kind kind, unsigned bytes)
      : medium_(medium), messages_(messages), queues_(medium, messages, kind), bytes_(bytes), nodes_(medium.nodes) {}

  /// The first byte of the node's slot leaves the master.
  void begin(NodeId node, Time at_master);
  /// The end of the frame with the last byte of the node's slot leaves the master.
  void end(NodeId node, Time at_master, Deliveries& deliveries);

 private:
  static constexpr std::size_t kNone = SendQueues::kNone;
  /// A message, or a part of one.
  struct Content {
    std::size_t message = kNone;
    bool whole = false;  ///< with its last byte
    Time home{};         ///< when the master has it
  };
  struct Node {
    Content own, repeated;
    std::deque<Content> at_master;
  };
  Duration to(NodeId destination) const;

  const Medium& medium_;
  const std::vector<Message>& messages_;
  SendQueues queues_;
  unsigned bytes_;
  std::vector<Node> nodes_;
};

}  // namespace limb_ring::study
