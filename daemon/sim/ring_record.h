#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "judge/due_pins.h"
#include "judge/forwarding_checker.h"
#include "judge/ledger.h"
#include "judge/receive_buffers.h"
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
    bool may_be_dropped = false;  ///< its input may have changed since: then a joining node says another hello
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
    a("began", began)("news_at", news_at)("control_home", control_home);
    a("hello_begun", hello_begun)("hello_left", hello_left)("hello_out", hello_out)("control", control)("damaged_at",
                                                                                                        damaged_at);
    a("interrupt_free", interrupt_free)("away_since", away_since);
    a("input_changed_at", input_changed_at)("dropped_until", dropped_until)("output_lost_at", output_lost_at)(
        "lines_crossed_at", lines_crossed_at);
  }

  /// Its hello has begun to leave since it began: in an open chain it has joined by that. (protocol.md section 4.8)
  bool hello_leaves() const { return hello_left || (hello_begun && *hello_begun >= began); }

  core::Settings settings;
  ForwardingChecker forwarding;
  ReceiveBuffers buffers;
  ReceiverModel receiver;
  DuePins pins;
  NodeHistory history;
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
    a("ledger", ledger)("was_broken", was_broken)("settled_from", settled_from)("said_hello", said_hello);
    a("released", released);
    for (const auto& node : nodes) a("node", *node);
  }

  NodeRecord& at(NodeId node) const { return *nodes[node]; }
  bool is_away(NodeId node) const { return node < nodes.size() && nodes[node]->away_since; }
  /// A beacon may have told the node of a break, which it shows when the instant is over.
  bool has_news(NodeId node, Time now) const;
  /// When the last bit is in of a slice that comes at `now`, as its last `tail_size` bytes begin.
  Time last_bit(NodeId node, std::size_t tail_size, Time now) const;
  /// After a fault some bounds are wider for a while.
  void disturbed(Time now) { settled_from = std::max(settled_from, now + settling); }
  /// The first broken promise is kept.
  void complain(Promise promise, std::string what);

  VirtualRing& ring;
  Complain on_complaint;
  Ledger ledger;
  std::vector<std::unique_ptr<NodeRecord>> nodes;
  bool was_broken = false;         ///< some line or node was ever lost
  core::Duration settling{0};      ///< after a fault no copies are under way for longer
  Time settled_from{};             ///< until then some bounds are wider, because of a fault before
  Time said_hello = core::kNever;  ///< the last hello of anybody
  Time released{};                 ///< a line has released what it held back
  std::optional<Violation> violation;
};

}  // namespace limb_ring::sim
