#pragma once

#include <algorithm>
#include <optional>

#include "core/counters.h"
#include "core/events.h"
#include "core/membership/peers.h"
#include "core/receive/duplicate_memory.h"
#include "core/settings.h"
#include "core/state_table.h"
#include "core/timers.h"
#include "core/transmit/transmit.h"

namespace limb_ring::core {

/// A row for each field of CpuReport: type, name, initial value, its name in a beacon, whether a beacon goes at once
/// when it has changed; otherwise it waits for the next one. A beacon says how long ago the CPU spoke.
#define LIMB_RING_CPU_REPORT(X)                                   \
  X(std::uint32_t, boots, 0, cpu_boots, true)                     \
  X(wire::CpuState, state, wire::CpuState::none, cpu_state, true) \
  X(bool, comes_back, true, cpu_comes_back, false)                \
  X(Time, spoke_at, {}, cpu_silent_ms, false)                     \
  X(bool, stop_latched, false, stop_latched, true)                \
  X(wire::ClockLatch, latch, {}, latch, false)
#define LIMB_RING_REPORTED(type, name, initial, told_as, at_once) type name = initial;
#define LIMB_RING_VISIT_REPORTED(type, name, initial, told_as, at_once) \
  visit(#name, &CpuReport::name, &wire::Beacon::told_as, at_once);
/// What the NC knows of its own CPU; beacons carry it.
struct CpuReport {
  LIMB_RING_CPU_REPORT(LIMB_RING_REPORTED)

  /// Calls visit(name, pointer to member, that of the beacon, at once) for each.
  template <class Visit>
  static void fields(const Visit& visit) {
    LIMB_RING_CPU_REPORT(LIMB_RING_VISIT_REPORTED)
  }
  /// It differs in something for which a beacon goes at once.
  bool is_news_after(const CpuReport& before) const {
    bool news = false;
    fields([&](const char*, auto member, auto, bool at_once) {
      news = news || (at_once && !(this->*member == before.*member));
    });
    return news;
  }
  template <class Archive>
  void archive(Archive& a) {
    fields([&](const char* name, auto member, auto, bool) { a(name, this->*member); });
  }
};

/// This node's place in the ring, as a state machine: hello and join, beacons and what they say of the others, ring
/// size, duplicate ids, broken lines and the open chain, folds. Its table is in membership.cpp. (ours, protocol.md
/// sections 4.7, 4.8 and 8.1 to 8.6)
class Membership {
 public:
  Membership(const Settings& settings, Transmit& transmit, DuplicateMemory& memory, Counters& counters,
             EventQueue& events);

  NodeState state() const { return state_; }
  std::uint64_t boot() const { return boot_; }
  /// Nodes in the ring, from the HOP of own packets that came home; 0 while none has.
  unsigned ring_size() const { return ring_size_; }
  const Peers& peers() const { return peers_; }
  /// The broken line, as the node behind it says, which may be this node; nothing if no break is known.
  std::optional<BrokenLine> broken_line() const { return break_.line(); }
  /// The own hello has come home since the node started, or started over: packets of users are taken.
  bool joined() const { return joined_; }
  /// Users may send.
  bool accepts_sends() const { return state_ == NodeState::open_chain || closed(); }

  /// @name The node's lines
  ///@{
  void input_up(NodeId from, bool folded, Time now);
  void input_lost(Time now);
  void output_up(NodeId to, bool folded, Time now);
  void output_lost(Time now);
  /// The neighbours on the first line, also while the second line stands for it.
  void set_neighbours(NodeId before, NodeId next) {
    input_.neighbour = before;
    output_.neighbour = next;
  }
  /// Whether the second line stands for the input, and for the output (fold_back.h).
  void set_folded(bool input, bool output, Time now);
  ///@}

  void set_cpu(const CpuReport& report, Time now);

  /// @name Packets
  ///@{
  /// A control packet of another node, before Receive decides on it.
  /// @return false if it is of an earlier incarnation of its source, and says nothing
  bool heard(const wire::PacketFields& packet, Time now);
  /// True for a retry of a source that has not been heard since this node started: the node may have taken its first
  /// try before that start. The source may not know of the start if it was in the other part of a ring that was broken
  /// twice. (ours, protocol.md section 4.10)
  bool is_unheard_nodes_retry(const wire::PacketFields& packet) {
    if (packet.code().attempt == 0 || !settings_.falls_into_parts() || peers_[packet.source()].known) return false;
    return counted(counters_.retries_of_unheard_nodes, true);
  }
  /// True for a retry while other nodes may not know of this node's start: until its hello, or a beacon with the
  /// present boot number, is home, and where the ring folds back, until the tries of a packet are over then: that may
  /// have gone round in one of two parts alone. This node may have taken the first try before that start. (ours,
  /// protocol.md section 4.10)
  bool is_unaware_nodes_retry(const wire::PacketFields& packet, Time at) {
    if (packet.code().attempt == 0 || known_to_all_from_ <= at) return false;
    return counted(counters_.retries_of_unaware_nodes, true);
  }
  /// An own packet came home as sent: the ring is closed and has hop + 1 nodes.
  void came_home(std::uint8_t hop, Time now);
  /// An own packet came home with a good CRC, whether it matched anything or not.
  void own_seen(const wire::PacketFields& packet, bool matched, Time now);
  /// True if an own packet that came home with that HOP shows that two parts of a ring have grown together. Nodes of
  /// the other part may have missed hellos, so their verdict may be on an older packet with the same number. One node
  /// more is not a merger: it was alone, has forgotten everything and says hello itself. (ours, protocol.md
  /// section 4.10)
  bool has_merged(std::uint8_t hop, Time now) const {
    if (merged_ || ring_size_ == 0 || hop <= ring_size_) return merged_;
    return settings_.several_hosts || (settings_.fold_back && now < fold_.over);
  }
  ///@}

  /// Acts on ends of the NC's own sends, and on sequence numbers that are used up. Part of Blocks::settle(), behind
  /// every input.
  /// @return true if there was something to act on
  bool settle(Time now) {
    const bool ended = transmit_.data.has_control_end();
    if (ended) control_ended(now);
    const bool due = (hello_.renumbering || merged_ || transmit_.numbers_exhausted()) && !hello_under_way();
    if (due) on(Input::numbers_due, now);
    return ended || due;
  }
  void handle_timeout(Time now) {
    if (deadline() <= now) act_on_time(now);
  }
  Time deadline() const { return timers_.next(); }

  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("state", state_)("boot", boot_)("ring_size", ring_size_)("peers", peers_)("cpu", cpu_);
    a("input", input_)("output", output_)("joined", joined_)("known_to_all_from", known_to_all_from_);
    a("hello", hello_)("beacon", beacon_)("merged", merged_)("duplicate_signs", duplicate_signs_)("break", break_);
    a("fold", fold_)("timers", timers_);
  }

 private:
  /// What can change the state.
  enum class Input : std::uint8_t {
    both_lines_up,    ///< both are up, and one has just come up
    both_lines_lost,  ///< since an own packet last came home: this node was bypassed, perhaps it was only frozen
    hello_home,
    hello_lost,  ///< both lines are up
    hello_lost_no_line,
    own_packet_home,
    own_control_home,  ///< a hello or beacon with the present boot number
    numbers_due,       ///< new ones: the old are used up, or two parts of the ring have grown together
    break_known,       ///< of a line around which nothing is folded
    drained,           ///< the open chain is closed again, and nothing old is under way
    duplicate_id
  };
  /// The next state; `closed` is up, alone or folded.
  enum class Next : std::uint8_t { same, starting, joining, closed, open_chain, duplicate_id };
  using Row = Transition<Membership, Input, Next>;
  static const Row kTable[];
  void on(Input input, Time now);
  void enter(NodeState state, Time now);
  /// In a closed ring.
  bool closed() const { return state_ == NodeState::up || state_ == NodeState::alone || state_ == NodeState::folded; }
  NodeState closed_state() const;
  /// Ring size or folds may have changed.
  void update_closed_state(Time now) {
    if (closed()) enter(closed_state(), now);
  }

  /// @name What is done with a transition
  ///@{
  void start_over(Time now);
  void begin_incarnation(Time now);
  void say_hello(Time now);
  void say_hello_if_lines_up(Time now);
  void join(Time now);
  void renumber(Time now);
  void go_on_unconfirmed(Time now);
  void say_hello_into_chain(Time now);
  void start_drain(Time now);
  void stop_drain(Time) { timers_.stop(Timer::drained); }
  void confirm_again(Time now);
  void beacon_changed(Time now);
  ///@}

  void lines_changed(Time now);
  void forget_lost_lines();
  bool lines_up() const { return input_.up() && output_.up(); }
  /// It is out, or will be said again.
  bool hello_under_way() const { return hello_.out || timers_.runs(Timer::hello); }
  void next_boot();
  void control_ended(Time now);
  void hello_ended(const SendEnded& ended, Time now);
  void hello_lost(Time now);

  bool heard_hello(const wire::PacketFields& packet, const wire::Hello& hello, Time now);
  bool heard_beacon(const wire::PacketFields& packet, const wire::Beacon& beacon, Time now);
  void duplicate_id_sign(std::uint8_t hop);
  void own_control_seen(std::uint64_t boot, std::uint8_t hop, Time now);

  void send_beacon_along(Time now);
  void send_beacon(Time now);
  wire::Beacon beacon(Time now) const;
  void act_on_time(Time now);

  void watch_for_break(Time now);
  void own_input_broken(Time now);
  void break_known(Time now);
  void look_for_folds(Time now);
  bool says_folded(const Peer& peer, Time now) const;

  const Settings& settings_;
  Transmit& transmit_;
  DuplicateMemory& memory_;
  Counters& counters_;
  EventQueue& events_;

  /// From one own beacon to the next. The further behind a node is in the order, the longer: so the first one leads,
  /// and its beacon is there before the timer of any other node ends. (ours, protocol.md section 8.2)
  const Duration beacon_period_;

  NodeState state_ = NodeState::starting;
  std::uint64_t boot_;
  unsigned ring_size_ = 0;
  Peers peers_;
  CpuReport cpu_;

  /// One of this node's two ends of the first line.
  struct LineEnd {
    wire::LinkState state = wire::LinkState::down;  ///< down: it was never up
    NodeId neighbour{0};
    bool was_lost = false;  ///< since an own packet last came home
    bool folded = false;    ///< the second line stands for it
    template <class Archive>
    void archive(Archive& a) {
      a("state", state)("neighbour", neighbour)("was_lost", was_lost)("folded", folded);
    }
    bool up() const { return state == wire::LinkState::up; }
    void lose() {
      state = wire::LinkState::silent;
      was_lost = true;
    }
    wire::LinkState shown() const { return up() && folded ? wire::LinkState::folded : state; }
  };
  LineEnd input_, output_;

  bool joined_ = false;
  Time known_to_all_from_ = kNever;  ///< its start
  bool merged_ = false;              ///< with another part of the ring: numbers start again at 0
  unsigned duplicate_signs_ = 0;     ///< since an own packet last came home

  struct {
    bool out = false;
    Time said{};
    bool renumbering = false;  ///< the hello that is out, or comes next, begins new numbers
    template <class Archive>
    void archive(Archive& a) {
      a("out", out)("said", said)("renumbering", renumbering);
    }
  } hello_;

  struct {
    bool out = false;
    bool wanted = false;  ///< something changed while one was out
    template <class Archive>
    void archive(Archive& a) {
      a("out", out)("wanted", wanted);
    }
  } beacon_;

  KnownBreak break_;

  struct {
    bool known = false;  ///< here or elsewhere in the ring
    Time over{};         ///< until then one is known, or was a short time ago
    template <class Archive>
    void archive(Archive& a) {
      a("known", known)("over", over);
    }
  } fold_;

  enum class Timer : std::uint8_t {
    own_break,  ///< the input, lost or folded, counts as a broken line from then on
    drained,    ///< the open chain ends
    hello,      ///< it has ended lost, and is said again
    beacon,     ///< the next one is due
    count
  };
  Timers<Timer> timers_;
};

}  // namespace limb_ring::core
