#pragma once

#include <algorithm>
#include <optional>

#include "core/counters.h"
#include "core/events.h"
#include "core/membership/peers.h"
#include "core/receive/receive.h"
#include "core/settings.h"
#include "core/transmit/transmit.h"

namespace limb_ring::core {

/// What the NC knows of its own CPU; beacons carry it.
struct CpuReport {
  std::uint32_t boots = 0;
  wire::CpuState state = wire::CpuState::none;
  bool comes_back = true;  ///< somebody starts it again when a reset kills it
  Time spoke_at{};  ///< when it last spoke; beacons say how long ago that was
};

/// This node's place in the ring: hello, beacons, what they say of the others, the learned ring
/// size, doubled ids, a broken ring. (ours, protocol.md sections 4.7, 4.8 and 8.1 to 8.6)
class Membership {
 public:
  Membership(const Settings& settings, Transmit& transmit, Receive& receive, DuplicateMemory& memory,
             Counters& counters, EventQueue& events);

  NodeState state() const { return state_; }
  std::uint64_t boot() const { return boot_; }
  /// Nodes in the ring, from the HOP of own packets that came home; 0 while none has.
  unsigned ring_size() const { return ring_size_; }
  const Peers& peers() const { return peers_; }
  struct BrokenLine {
    NodeId before, behind;
  };
  /// As the node behind it, or that node itself, says. Nothing where the ring is whole as far as is known.
  std::optional<BrokenLine> broken_line() const {
    if (!break_known_) return std::nullopt;
    return BrokenLine{break_before_, break_behind_};
  }
  /// Users may send.
  bool accepts_sends() const {
    return state_ == NodeState::open_chain || settled();
  }

  void input_up(NodeId from, Time now);
  void input_lost(Time now);
  void output_up(NodeId to, Time now);
  void output_lost(Time now);
  void set_cpu(const CpuReport& report, Time now);
  void set_neighbours(NodeId before, NodeId next) {
    input_from_ = before;
    output_to_ = next;
  }
  /// The second line stands for the input, for the output (fold_back.h).
  void set_folded(bool input, bool output, Time now);

  /// An own packet came home with that HOP from a ring that has grown together out of two parts: nodes of the
  /// other part may have missed hellos, so their verdict may be on an older packet of the same number. One node
  /// more is no merger: it was alone, has forgotten everything and says hello itself. (ours, protocol.md section 4.10)
  bool has_merged(std::uint8_t hop, Time now) const {
    return merged_ || (settings_.fold_back && ring_size_ != 0 && hop > ring_size_ && now < fold_over_);
  }
  /// An own packet came home as sent: the ring is closed and has hop + 1 nodes.
  void came_home(std::uint8_t hop, Time now);
  /// An own packet came home with a good CRC, whether it matched anything or not.
  void own_seen(const wire::PacketFields& packet, bool matched, Time now);
  /// A control packet of another node, before Receive decides on it.
  /// @return false where it is of an earlier incarnation of its source, and says nothing
  bool heard(const wire::PacketFields& packet, Time now);

  void handle_timeout(Time now) {
    if (deadline() <= now) act_on_time(now);
  }
  /// After anything that may have ended a send of the NC's own, or used up sequence numbers.
  void settle(Time now) {
    if (transmit_.data.has_control_end()) control_ended(now);
    if (renumbering_ || merged_ || transmit_.numbers_exhausted()) renumber_when_settled(now);
  }
  Time deadline() const { return std::min(std::min(beacon_due_, break_due_), drained_at_); }

 private:
  enum class Link : std::uint8_t { never, up, lost };
  /// In a closed ring.
  bool settled() const {
    return state_ == NodeState::up || state_ == NodeState::alone || state_ == NodeState::folded;
  }
  NodeState settled_state() const;

  void act_on_time(Time now);
  void enter(NodeState state, Time now);
  void links_changed(Time now);
  bool links_up() const { return input_ == Link::up && output_ == Link::up; }
  void start_over(Time now);
  void new_life(Time now);
  void next_boot();
  void found_double(Time now);
  void say_hello(Time now);
  void hello_ended(const SendEnded& ended, Time now);
  void joined(Time now);
  void control_ended(Time now);
  void renumber_when_settled(Time now);
  void renumber(Time now);

  bool heard_hello(const wire::PacketFields& packet, const wire::Hello& hello, Time now);
  bool heard_beacon(const wire::PacketFields& packet, const wire::Beacon& beacon, Time now);

  void send_beacon(Time now);
  void change(Time now);
  wire::Beacon beacon(Time now) const;

  bool own_break() const { return break_known_ && break_behind_ == settings_.id; }
  void watch_for_break(Time now);
  void own_input_broken(Time now);
  void hear_break(const wire::Beacon& beacon, Time now);
  void enter_open_chain(Time now);
  void leave_open_chain(Time now);
  void own_control_seen(std::uint64_t boot, std::uint8_t hop, Time now);

  void look_for_folds(Time now);
  bool says_folded(const Peer& peer, Time now) const;

  const Settings& settings_;
  Transmit& transmit_;
  Receive& receive_;
  DuplicateMemory& memory_;
  Counters& counters_;
  EventQueue& events_;

  NodeState state_ = NodeState::starting;
  std::uint64_t boot_;
  unsigned ring_size_ = 0;
  Peers peers_;
  CpuReport cpu_;

  Link input_ = Link::never;
  Link output_ = Link::never;
  NodeId input_from_ = 0;
  NodeId output_to_ = 0;
  bool input_was_lost_ = false;   ///< since an own packet last came home
  bool output_was_lost_ = false;
  bool hello_out_ = false;
  bool renumbering_ = false;
  bool beacon_out_ = false;
  bool beacon_wanted_ = false;    ///< something changed while one was out
  Time beacon_due_ = kNever;
  Time break_due_ = kNever;       ///< the input, lost, counts as a broken line from then on
  Time drained_at_ = kNever;      ///< the open chain ends then: it is closed again, and nothing old is under way
  bool break_known_ = false;
  NodeId break_before_ = 0;
  NodeId break_behind_ = 0;
  bool input_folded_ = false;
  bool output_folded_ = false;
  bool folded_ = false;           ///< a fold is known, here or elsewhere in the ring
  bool merged_ = false;           ///< with another part of the ring: numbers begin anew
  Time fold_over_{};              ///< until then a fold is known, or was a short time ago
  unsigned doubled_signs_ = 0;    ///< since an own packet last came home
};

}  // namespace limb_ring::core
