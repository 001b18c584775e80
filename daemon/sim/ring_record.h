#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "judge/forwarding_checker.h"
#include "judge/ledger.h"
#include "judge/receiver_model.h"
#include "judge/sent_judge.h"
#include "sim/virtual_ring.h"

namespace limb_ring::sim {

/// What has been seen of one node, and the checks of it that need nothing else.
struct NodeRecord {
  /// The last hello or beacon that it has sent.
  struct OwnControl {
    std::uint8_t code = 0;
    std::uint32_t crc = 0;  ///< 0: none is out
    bool hello = false;
    bool may_be_dropped = false;  ///< a line of it may have come up since: then a joining node says another hello
    Time left{};

    template <class Archive>
    void archive(Archive& a) {
      a("code", code)("crc", crc)("hello", hello)("may_be_dropped", may_be_dropped)("left", left);
    }
  };

  NodeRecord(const core::Settings& of_node, Ledger& ledger, const Complain& complain);
  template <class Archive>
  void archive(Archive& a) {
    a("forwarding", forwarding)("buffers", buffers)("receiver", receiver)("pins", pins)("history", history);
    a("clock_stands", clock_stands)("began", began)("news_at", news_at)("control_home", control_home);
    a("hello_begun", hello_begun)("hello_left", hello_left)("hello_out", hello_out)("control", control)("damaged_at",
                                                                                                        damaged_at);
    a("interrupt_free", interrupt_free)("away_since", away_since);
    a("input_changed_at", input_changed_at)("dropped_until", dropped_until)("output_lost_at", output_lost_at)(
        "lines_crossed_at", lines_crossed_at);
  }

  /// A line has come up or gone, or seems so by a fold word: a node that is starting may start over, which it does not
  /// show; a joining node may say another hello, which may have to wait for the output.
  void line_may_have_changed() {
    control.may_be_dropped = true;
    if (history.state == core::NodeState::starting) receiver.may_start_over();
  }
  /// Its clock has stood: the last bit of what was coming in then is in so much later, by that clock.
  void clock_stood(Time from, Time until) {
    buffers.put_off(from, until - from);
    pins.put_off(from, until - from);
  }
  /// Its hello has begun to leave since it began: in an open chain it has joined by that. (protocol.md section 4.8)
  bool hello_leaves() const { return hello_left || (hello_begun && *hello_begun >= began); }

  core::Settings settings;
  ForwardingChecker forwarding;
  ReceiveBuffers buffers;
  ReceiverModel receiver;
  DuePins pins;
  NodeHistory history;
  bool clock_stands = false;         ///< since it was frozen: its host is suspended
  Time began{};                      ///< it started, or started over
  Time news_at{core::Duration{-1}};  ///< a hello or beacon of another node was in
  Time control_home{};               ///< its last hello or beacon came home: what a hello holds back may leave
  std::optional<Time> hello_begun;   ///< to leave, or another packet before the node has joined
  bool hello_left = false;
  bool hello_out = false;  ///< a hello has left and is not home: nothing else may leave
  OwnControl control;
  Time damaged_at{core::Duration{-1}};  ///< an own DATP last came home damaged
  Time interrupt_free{};                ///< its last own INTP ended
  std::optional<Time> away_since;       ///< killed or frozen
  Time input_changed_at{};
  Time dropped_until{core::Duration{-1}};  ///< it had no output when it last had that
  Time output_lost_at = core::kNever;      ///< or replaced
  Time lines_crossed_at = core::kNever;    ///< its input changed in the instant of that, but later
};

/// What has been seen of a virtual ring, from outside: shared by the checkers of what leaves nodes, of what comes into
/// them, and of results.
struct RingRecord {
  explicit RingRecord(VirtualRing& of_ring);
  RingRecord(const RingRecord&) = delete;
  RingRecord& operator=(const RingRecord&) = delete;
  /// All but a violation, after which nothing is judged.
  template <class Archive>
  void archive(Archive& a) {
    a("ledger", ledger)("was_broken", was_broken)("settled_from", settled_from)("released", released);
    for (const auto& node : nodes) a("node", *node);
  }

  NodeRecord& at(NodeId node) const { return *nodes[node]; }
  /// That instant by the node's own clock, by which it reckons how old a verdict is: it may have stood.
  Time by_clock_of(NodeId node, Time instant) const { return instant + ring.ahead(node); }
  bool is_away(NodeId node) const { return node < nodes.size() && nodes[node]->away_since; }
  /// A beacon may have told the node of a break, which it shows when the instant is over.
  bool has_news(NodeId node, Time now) const;
  /// When the last bit is in of a slice that comes at `now`, as its last `tail_size` bytes begin.
  Time last_bit(NodeId node, std::size_t tail_size, Time now) const;
  /// After a fault some bounds are wider for a while.
  void disturbed(Time now) { settled_from = std::max(settled_from, now + settling); }
  /// The first broken promise is kept.
  void complain(Promise promise, Words what);

  VirtualRing& ring;
  Complain on_complaint;
  Ledger ledger;
  std::vector<std::unique_ptr<NodeRecord>> nodes;
  bool was_broken = false;     ///< some line or node was ever lost
  core::Duration settling{0};  ///< after a fault no copies are under way for longer
  Time settled_from{};         ///< until then some bounds are wider, because of a fault before
  Time released{};             ///< a line has released what it held back
  std::optional<Violation> violation;
};

/// Judges the results that CPUs get: each send has one, in time, justified by the lines (ResultJudge) and by the state
/// that its node shows. (protocol.md sections 4.3 to 4.6)
class ResultChecker {
 public:
  explicit ResultChecker(RingRecord& record) : record_(record), unexplained_(record.ring.size()) {}

  void ends(NodeId node, const core::SendEnded& end, Time at_end);
  /// A state explains results that were given just before.
  void state_changes(NodeId node, core::NodeState state);
  /// The node has restarted.
  void start(NodeId node) { unexplained_[node].clear(); }
  /// Sends that are due by now must have ended. @param all true: all sends, at the end of a run
  void judge_open(NodeId node, bool all);
  /// Complains of results that no state has explained in time.
  void judge_unexplained(NodeId node);
  template <class Archive>
  void archive(Archive& a) {
    a("unexplained", unexplained_);
  }

 private:
  /// A result for which its node has to show a state.
  struct Unexplained {
    Time when;
    core::Outcome outcome;
    Words what;

    template <class Archive>
    void archive(Archive& a) {
      a("when", when)("outcome", outcome)("what", what);
    }
  };

  ResultJudge judge_of(NodeId node, const Sent& sent) const;

  RingRecord& record_;
  std::vector<std::vector<Unexplained>> unexplained_;  ///< by node
};

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
