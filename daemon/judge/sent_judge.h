#pragma once

#include <deque>

#include "core/events.h"
#include "judge/ledger.h"
#include "judge/promise.h"

namespace limb_ring::sim {

/// What has happened to a node that can end its sends.
struct NodeHistory {
  core::NodeState state = core::NodeState::starting;
  Time state_at{};                ///< since when
  Time open_chain_until{};        ///< it was in an open chain before it showed another state; 0: never
  Time cancelled = core::kNever;  ///< its CPU was reset, or its sends were cancelled
  Time thawed{};                  ///< it went on

  template <class Archive>
  void archive(Archive& a) {
    a("state", state)("state_at", state_at)("open_chain_until", open_chain_until)("cancelled", cancelled);
    a("thawed", thawed);
  }
};

/// Whether a result was justified when it was given, by what was seen on the lines. (protocol.md sections 4.3 to 4.6)
class ResultJudge {
 public:
  ResultJudge(const Sent& sent, const core::Settings& settings, const NodeHistory& source, bool ring_was_broken)
      : sent_(sent), settings_(settings), source_(source), ring_was_broken_(ring_was_broken) {}

  /// @return what speaks against it; null if nothing does
  const char* objection() const;
  /// Until when it must have ended. (protocol.md sections 4.3 and 4.5)
  Time due() const;

 private:
  bool home() const { return sent_.home_at == sent_.ended_at; }
  bool overdue() const { return sent_.ended_at >= sent_.asked + settings_.queue_timeout; }
  bool receiver_forgot() const;
  bool tries_are_over() const;
  const char* against_delivered() const;
  const char* against_refused() const;
  const char* against_no_such_node() const;
  const char* against_lost() const;
  const char* against_unconfirmed() const;
  const char* against_rejected() const;

  const Sent& sent_;
  const core::Settings& settings_;
  const NodeHistory& source_;
  bool ring_was_broken_;
};

/// What a packet says is acted on when its `end` begins; what follows is told when its last bit is in, at most so much
/// later: an INTP begins and ends with the same slice, which is the longest. (protocol.md section 6.4)
inline core::Duration told_within(const core::Settings& settings) {
  return settings.byte_time_in * static_cast<std::int64_t>(wire::kInterruptPacketSize);
}

/// In a ring, or in an open chain: users may send. (protocol.md section 8.1)
inline bool may_send(core::NodeState state) {
  using core::NodeState;
  return state == NodeState::up || state == NodeState::alone || state == NodeState::folded ||
         state == NodeState::open_chain;
}

/// The pins that one node has to pull, and when: each once, and none besides. (protocol.md section 5.3)
class DuePins {
 public:
  DuePins(wire::NodeId node, const Complain& complain) : node_(node), complain_(complain) {}

  /// The last bit of an INTP is in. @param sure false: perhaps it was taken before
  void put(wire::NodeId source, wire::Factor factor, core::Time at, bool sure);
  void pulled(const core::PinPulled& pin, core::Time at);
  /// Pins that were due before `now` must have been pulled.
  void judge(core::Time now) {
    if (!due_.empty() && due_.front().at < now) drop_before(now);
  }
  /// What is due later than `from` is due so much later.
  void put_off(core::Time from, core::Duration by) {
    for (Due& due : due_)
      if (due.at > from) due.at += by;
  }
  void clear() { due_.clear(); }
  template <class Archive>
  void archive(Archive& a) {
    a("due", due_);
  }

 private:
  struct Due {
    wire::NodeId source;
    wire::Factor factor;
    core::Time at;
    bool sure;

    template <class Archive>
    void archive(Archive& a) {
      a("source", source)("factor", factor)("at", at)("sure", sure);
    }
  };
  void drop_before(core::Time now);

  wire::NodeId node_;
  const Complain& complain_;
  std::deque<Due> due_;
};

}  // namespace limb_ring::sim
