#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sim/due_pins.h"
#include "sim/forwarding_checker.h"
#include "sim/ledger.h"
#include "sim/packet_collector.h"
#include "sim/receive_buffers.h"
#include "sim/receiver_model.h"
#include "sim/result_judge.h"
#include "sim/virtual_ring.h"

namespace limb_ring::sim {

/// Checks every promise of the ring at every event of a virtual ring, from outside: it knows what CPUs ask for and
/// get, the slices on the lines, the pins, and the state that a node shows; never what the controller counts. The first
/// broken promise is kept.
class Invariants : public Observer {
 public:
  /// Watches `ring` from now on; must live as long as it runs.
  explicit Invariants(VirtualRing& ring);

  const std::optional<Violation>& violation() const { return violation_; }
  /// At the end, when nothing is under way any more: everything asked for must have ended.
  void finish();

  void asked(NodeId node, const core::SendRequest& request, Time now) override;
  void asked(NodeId node, const core::InterruptRequest& request, Time now) override;
  void leaves(NodeId node, const wire::Slice& slice, Time now) override;
  void arrives(NodeId node, const wire::Slice& slice, Time now) override;
  void input_changes(NodeId node, Line line, Time now) override;
  void output_ready(NodeId node, bool ready, Time now) override;
  void cpu_present(NodeId node, bool present, Time now) override;
  void event(NodeId node, const core::Event& event) override;
  void packet(NodeId node, const core::ReceivedPacket& packet) override;
  void incident(NodeId node, Incident incident, Time now, Line line) override;

 private:
  /// The last hello or beacon that a node has sent.
  struct OwnControl {
    std::uint8_t code = 0;
    std::uint32_t crc = 0;  ///< 0: none is out
    bool hello = false;
    Time left{};
  };
  /// A result for which its node has to show a state.
  struct Unexplained {
    Time when;
    core::Outcome outcome;
    std::string what;
  };
  struct Node {
    Node(const core::Settings& of_node, Ledger& ledger, const Complain& complain);
    core::Settings settings;
    ForwardingChecker forwarding;
    ReceiveBuffers buffers;
    ReceiverModel receiver;
    DuePins pins;
    PacketCollector coming, going;     ///< the DATPs on its lines
    Tristate received = Tristate::no;  ///< the one that is coming in
    bool coming_own = false, going_own = false;
    PacketHeader header;  ///< of the one that is going out
    Time going_since{};
    Line input = Line::first, output = Line::first;
    NodeHistory history;
    Time began{};  ///< it started, or started over
    std::vector<Unexplained> unexplained;
    Time arrived{};                    ///< when something last did
    Time news_at{core::Duration{-1}};  ///< a hello or beacon of another node was in
    Time control_home{};               ///< its hello came home: what it held back may leave
    bool hello_left = false;
    bool hello_out = false;  ///< and is not home: nothing else may leave
    OwnControl control;
    Time interrupt_free{};           ///< its last own INTP ended
    std::optional<Time> away_since;  ///< killed or frozen
  };

  Node& at(NodeId node) { return *nodes_[node]; }
  void check_header(NodeId node, const PacketHeader& header);
  bool is_away(NodeId node) const { return node < nodes_.size() && nodes_[node]->away_since; }
  void check_source(NodeId node, const PacketHeader& header, Time now);
  void begins_to_leave(NodeId node, const wire::Slice& slice, Time now);
  void data_leaves(NodeId node, const wire::Slice& end, wire::ByteView own, Time now);
  void own_data_leaves(NodeId node, const wire::PacketFields& packet);
  void interrupt_leaves(NodeId node, const wire::Slice& slice, Time now);
  void breaks_off(NodeId node, std::size_t size, Time now);
  void begins_to_arrive(NodeId node, const wire::Slice& slice);
  Tristate is_received(NodeId node, wire::ByteView bytes, bool interrupt);
  void data_arrives(NodeId node, const wire::PacketFields& packet, Time now, Time at_end);
  void interrupt_arrives(NodeId node, const wire::PacketFields& packet, Time now);
  ReceiverModel::Answer offer(NodeId node, const wire::PacketFields& packet, Sent* sent, Tristate received,
                              Time at_end);
  ReceiverModel::Answer offer_interrupt(NodeId node, const wire::PacketFields& packet, Sent* sent, Tristate received,
                                        Time at_end);
  ForwardingChecker::Due due(NodeId node, ReceiverModel::Answer answer, const wire::PacketFields& packet,
                             std::size_t free) const;
  bool has_news(NodeId node, Time now) const;
  Tristate has_buffer(NodeId node, const wire::PacketFields& packet);
  void comes_home(NodeId node, const wire::PacketFields& packet, Time at_end);
  void state_changes(NodeId node, core::NodeState state, Time now);
  Sent* on_line(const wire::PacketFields& packet);
  Time last_bit(NodeId node, std::size_t tail_size, Time now) const;
  void ends(NodeId node, const core::SendEnded& end, Time at);
  ResultJudge judge_of(NodeId node, const Sent& sent) const;
  Time last_hello_of(NodeId destination) const;
  void judge_open(NodeId node, bool all);
  void judge_unexplained(NodeId node);
  void check_insertion(NodeId node, Time now);
  void disturbed(Time now) { settled_from_ = std::max(settled_from_, now + settling_); }
  void complain(Promise promise, std::string what);

  VirtualRing& ring_;
  Complain complain_;
  Ledger ledger_;
  std::vector<std::unique_ptr<Node>> nodes_;
  bool was_broken_ = false;     ///< some line or node was ever lost
  core::Duration settling_{0};  ///< after a fault no copies are under way for longer
  Time settled_from_{};         ///< nothing has been lost, damaged or ended for so long: some bounds are wider before
  Time said_hello_ = core::kNever;  ///< the last hello of anybody
  Time released_{};                 ///< a line has released what it held back
  std::optional<Violation> violation_;
};

}  // namespace limb_ring::sim
