#pragma once

#include <vector>

#include "judge/forwarding_checker.h"
#include "sim/ring_record.h"

namespace limb_ring::sim {

/// Judges what comes into the nodes of a ring: what each has to receive, with which FBC it has to pass it on, and which
/// own packets are home; also what waits in its insertion buffer. (protocol.md sections 2.2, 2.3, 2.5 and 4.10)
class InputChecker {
 public:
  explicit InputChecker(RingRecord& record);

  void arrives(NodeId node, const wire::Slice& slice, Time now);
  void word_arrives(NodeId node, wire::FoldWord word, Line line, Time now);
  void input_changes(NodeId node, Line line, Time now);
  /// The node has restarted: what is on its way in is dropped.
  void start(NodeId node) {
    incoming_[node].collector.drop();
    incoming_[node].fold_known_until = Time{};
  }
  template <class Archive>
  void archive(Archive& a) {
    for (Incoming& in : incoming_) a("incoming", in);
  }

 private:
  /// The DATP that is on its way into a node, and the lines of that node.
  struct Incoming {
    PacketCollector collector;
    Tristate received = Tristate::no;
    bool own = false;
    Line input = Line::first, output = Line::first;
    Time last{};              ///< when something last came
    Time fold_known_until{};  ///< from the last `begin` of a fold node on, unless something has happened since

    template <class Archive>
    void archive(Archive& a) {
      a("collector", collector)("received", received)("own", own)("input", input)("output", output)("last", last);
      a("fold_known_until", fold_known_until);
    }
  };

  void follow_input(NodeId node, Time now);
  void input_breaks_off(NodeId node, Time now);
  void breaks_off(NodeId node, std::size_t size, Time now);
  void begins_to_arrive(NodeId node, const wire::Slice& slice);
  Tristate is_received(NodeId node, wire::ByteView bytes, bool interrupt);
  void data_arrives(NodeId node, const wire::PacketFields& packet, Time now, Time at_end);
  void interrupt_arrives(NodeId node, const wire::PacketFields& packet, Time now);
  ReceiverModel::Answer offer(NodeId node, const wire::PacketFields& packet, Sent* sent, Tristate received,
                              Time at_end);
  ReceiverModel::Answer offer_interrupt(NodeId node, const wire::PacketFields& packet, Sent* sent, Tristate received,
                                        Time at_end);
  Tristate has_buffer(NodeId node, const wire::PacketFields& packet);
  void comes_home(NodeId node, const wire::PacketFields& packet, Time at_end);
  Sent* on_line(NodeId node, const wire::PacketFields& packet);
  void check_insertion(NodeId node, Time now);

  RingRecord& record_;
  std::vector<Incoming> incoming_;
};

}  // namespace limb_ring::sim
