#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <queue>
#include <vector>

#include "config/fault.h"
#include "core/network_controller.h"
#include "judge/ledger.h"
#include "sim/delay_line.h"
#include "sim/observer.h"

namespace limb_ring::sim {

using core::NetworkController;

/// What a virtual ring is made of.
struct VirtualRingOptions {
  unsigned nodes = 4;                                    ///< 1 to 255; their ids are 0, 1, 2 ...
  core::RingOrder order;                                 ///< ... unless these are, in ring order
  Duration byte_time{0};                                 ///< on every line; 8 ns is 1 Gbit/s
  Duration relay_delay = std::chrono::nanoseconds(512);  ///< d: line and NC, before the Packet Manager
  bool start = true;                                     ///< false: nodes stay dead until start()
  bool keep_logs = true;                                 ///< false: events and packets go to the callbacks only
  /// How long it takes until the ends of a line know each other, drawn for each end; null: no time.
  std::function<Duration()> connecting;
  /// How long it takes until an end of a line that is gone notices that, drawn for each end; null: no time. A line is
  /// connected again only when both its ends have noticed.
  std::function<Duration()> noticing;
  /// By how many millionths a node's clock is too fast, -100000 to 100000: then all times that it keeps are so much
  /// shorter. Its lines have rates of their own. Null: all clocks are right.
  std::function<int(NodeId)> drift;
  /// Last changes to a node's settings; its relay_delay is that of the line into it.
  std::function<void(core::Settings&)> adjust = [](core::Settings&) {};
};

/// Scales all times that a node with these settings keeps: its clock is wrong.
/// @param ppm by how many millionths it is too fast; below 0 too slow
void let_drift(core::Settings& settings, int ppm);

class VirtualRing;
/// Does a fault step_clock.
void step_clocks(VirtualRing& ring, const fault::Fault& fault);

/// What one node was given: its events and packets, in order.
struct NodeLog {
  std::vector<core::Event> events;
  std::vector<core::ReceivedPacket> packets;
};

/// A ring of network controllers, the very ones of the daemon, under a virtual clock: no socket,
/// no thread, no waiting. Lines are intact and in order unless a tap says otherwise; a dead node
/// is bypassed at once, as the daemon's links do it.
class VirtualRing {
 public:
  /// The owner of what send(), interrupt() and pull() ask for: no client of a host port has this number
  /// (node/session.h).
  static constexpr core::Owner kUser = kAskedByRing;

  explicit VirtualRing(const VirtualRingOptions& options);

  Time now() const { return now_; }
  /// What the monotonic clock of a node shows, by which its controller lives: that of the ring, but for the times that
  /// it stood, or has skipped. All that observers and callbacks are told is of the ring's clock.
  Time time_of(NodeId id) const { return clocks_differ_ ? now_ + ahead(id) : now_; }
  /// The host of the node is suspended.
  bool clock_stands(NodeId id) const { return nodes_[id].stands_since != core::kNever; }
  /// By how much it is ahead of the ring's; below 0 behind it.
  Duration ahead(NodeId id) const {
    const Node& n = nodes_[id];
    const Duration stood = n.stands_since == core::kNever ? Duration{0} : now_ - n.stands_since;
    return (n.clock_steps.empty() ? Duration{0} : n.clock_steps.back().ahead) - stood;
  }
  /// An instant of that clock on the ring's, also one before its last steps; kNever remains.
  Time in_ring(NodeId id, Time of_node) const {
    const bool same = !clocks_differ_ || nodes_[id].clock_steps.empty() || of_node == core::kNever;
    return same ? of_node : before_steps(id, of_node);
  }
  /// For calls that change something at a node: before time goes on, the node may then use its lines, and its events
  /// are taken.
  NetworkController& node(NodeId id) {
    touch(id);
    return *nodes_[id].controller;
  }
  /// One above the largest id.
  unsigned size() const { return static_cast<unsigned>(nodes_.size()); }
  /// The same controller, for reading: nothing follows from that. Who changes something all the same calls node()
  /// afterwards.
  NetworkController& controller(NodeId id) { return *nodes_[id].controller; }
  const core::RingOrder& order() const { return options_.order; }
  core::Lines lines() const { return nodes_.front().controller->lines(); }
  const core::Settings& settings(NodeId id) const { return nodes_[id].controller->settings(); }
  const core::Counters& counters(NodeId id) const { return nodes_[id].controller->counters(); }
  /// The lines that its packets come on, and leave on.
  Line input_line(NodeId id) const { return nodes_[id].controller->input_line(); }
  Line output_line(NodeId id) const { return nodes_[id].controller->output_line(); }
  /// Somebody is at the other end of output_line().
  bool has_output(NodeId id) const {
    const auto line = static_cast<std::size_t>(output_line(id));
    return nodes_[id].lines[line].successor >= 0 || nodes_[id].outputs[line].loses_it();
  }
  /// Who is at the other end of the line into it, or out of it; nothing: nobody, or the wire is cut.
  std::optional<NodeId> predecessor(NodeId id, Line line = Line::first) const;
  std::optional<NodeId> successor(NodeId id, Line line = Line::first) const;
  NodeLog& log(NodeId id) { return nodes_[id].log; }
  bool alive(NodeId id) const { return nodes_[id].alive; }

  /// Node `id` sends; @return the token its SendEnded will carry (owner kUser)
  std::uint32_t send(NodeId id, NodeId destination, const std::vector<std::uint8_t>& data, std::uint8_t priority = 0,
                     std::uint8_t channel = 0);
  std::uint32_t interrupt(NodeId id, NodeId destination, std::uint8_t factor);
  std::uint32_t pull(NodeId id, unsigned input);
  /// Its CPU takes the next packet that waits for it. @return false if there is none
  bool take(NodeId id, core::ReceivedPacket& packet);
  /// The CPU of node `id` is reset: its sends end, its receive buffers are emptied.
  void reset_cpu(NodeId id);
  /// Its CPU is there, or gone; a node that starts has one.
  void set_cpu_present(NodeId id, bool present);
  /// Its CPU takes its packets (true, as from the start), or reads nothing.
  void set_cpu_reads(NodeId id, bool reads);
  bool cpu_reads(NodeId id) const { return nodes_[id].cpu_reads; }
  /// Its sends end cancelled.
  void cancel(NodeId id);
  /// The end of that send; null if it has not ended.
  const core::SendEnded* ended(NodeId id, std::uint32_t token) const;

  /// Does `action` at that instant, before any node decides what to put onto its line in it.
  void at(Time time, std::function<void()> action);
  /// Runs everything that happens up to and at `until`.
  void run_until(Time until);
  /// When something happens next, as far as is known; kNever: nothing will.
  Time next_instant() const;
  void run_for(Duration duration) { run_until(now_ + duration); }
  /// Runs until `done`, checked after every instant. @return false if `limit` was reached first
  bool run_until(const std::function<bool()>& done, Duration limit);
  /// Runs until every living node has joined.
  /// @param asked_to_stop asked once in each millisecond of the ring's time; true: it runs no longer
  /// @return false if 10 s were not enough, or it was asked to stop
  bool join(const std::function<bool()>& asked_to_stop = [] { return false; });

  /// The node's process ends; its neighbours bypass it, or the line is left open.
  void kill(NodeId id);
  /// A new process of that node, with a higher boot number.
  void start(NodeId id);
  /// The node's process stops and is bypassed; later it goes on, and finds both its links gone.
  /// @param clock_stands its monotonic clock stands, too, until it goes on or starts anew: its host is suspended
  void freeze(NodeId id, bool clock_stands = false);
  void thaw(NodeId id);
  /// The node's process stops for a while: what comes in waits, its lines stay up, and it goes on where it was.
  void pause(NodeId id);
  void resume(NodeId id);
  bool paused(NodeId id) const { return nodes_[id].paused; }
  /// The monotonic clock of a node skips that time: all deadlines within it are due at once. @param by >= 0
  void skip_time(NodeId id, Duration by);
  /// The wall clock of a node is set forward, or back: its next boot number comes from there. @param by below 0: back
  void step_wall_clock(NodeId id, Duration by) { nodes_[id].wall_ahead += by; }
  /// The lines out of the node take nothing more for now (false), or again.
  void set_output_ready(NodeId id, bool ready);
  /// A wire out of node `id`: cut, whole again. The node behind learns of it at once, the one
  /// before it does not; with VirtualRingOptions::noticing both learn of it, each in its time, and if the wire is whole
  /// before that, what was lost is a gap. @pre the ring folds back, for the second
  void cut(NodeId id, Line line = Line::first);
  void heal(NodeId id, Line line = Line::first);
  /// If the ring folds back: the cable between `id` and the node after it, which is a wire of each
  /// line, and of which both ends learn at once.
  void cut_cable(NodeId id);
  void heal_cable(NodeId id);
  /// These nodes and the others no longer reach each other, as if on two hosts that lose each other: each part closes
  /// a ring without the other one.
  void part(const core::RingOrder& these);
  /// All reach each other again, and close one ring.
  void regroup() { part({}); }

  /// @name A node that is not ours. Its line has no rate; who starts and kills it is its owner
  ///@{
  /// @param guest outlives this @pre node `id` is dead, and the ring does not fold back
  void set_guest(NodeId id, Guest& guest) { nodes_[id].guest = &guest; }
  bool is_guest(NodeId id) const { return nodes_[id].guest != nullptr; }
  /// It has taken the line of the node before it.
  void guest_accepts(NodeId id);
  /// The node after it has taken its line.
  void guest_connected(NodeId id);
  /// Something is missing on its line out.
  void guest_gap(NodeId id);
  ///@}

  /// Sees every slice that leaves node `id` on that line and may change what arrives: put what shall arrive
  /// into `arriving` (empty: lost).
  using Tap = std::function<void(const wire::Slice& slice, Time now, wire::SliceWriter& arriving)>;
  void tap(NodeId id, Tap tap, Line line = Line::first) { wire_of(id, line).tap = std::move(tap); }
  /// What a tap has held back goes onto the line out of `id` now; leaves `slices` empty.
  void put_late(NodeId id, wire::SliceWriter& slices, Line line = Line::first);
  /// All that later events depend on, except what at() was asked for, what taps hold, and logs.
  /// (study/exploration.h) @pre between two instants
  template <class Archive>
  void archive(Archive& a) {
    a("now", now_)("nodes", nodes_);
    for (unsigned id = 0; id < size(); ++id) {
      Time wake = wakes_[id];
      a("wake", wake);
    }
    for (DelayLine& delay_line : delay_lines_)
      delay_line.each([&](DelayLine::Arrival& arrival) {
        if (wire_of(arrival.from, arrival.line).epoch == arrival.epoch) a("arrival", arrival);  // else it is lost
      });
  }

  /// Told of everything from now on; must outlive the ring.
  void add_observer(Observer& observer);
  /// Tells the observers that a tap lost or damaged something on the line out of `id`, or that its
  /// CPU was reset or had its sends cancelled.
  void tell(NodeId id, Incident incident, Line line = Line::first);
  /// Called for each event and packet as it comes out of a node; may send.
  std::function<void(NodeId, const core::Event&)> on_event = [](NodeId, const core::Event&) {};
  std::function<void(NodeId, const core::ReceivedPacket&)> on_packet = [](NodeId, const core::ReceivedPacket&) {};
  /// Called after these, if a node has given something out, or packets wait in it for its CPU.
  std::function<void(NodeId)> on_given_out = [](NodeId) {};

 private:
  /// The wire of a line out of a node, and who sends into it.
  struct Wire {
    bool cut = false;
    int successor = -1;
    int former = -1;  ///< the last successor
    int predecessor = -1;
    std::uint64_t epoch = 0;      ///< goes up when the line ends: what is under way from before is lost
    std::uint64_t connected = 0;  ///< how often it was connected; a cut does not change that
    Tap tap;

    template <class Archive>
    void archive(Archive& a) {
      a("cut", cut)("successor", successor)("predecessor", predecessor);
    }
  };
  /// An end of a line, as its node sees it.
  struct End {
    int told = -1;                ///< who is at the other end; -1: nobody
    Time notices = core::kNever;  ///< that it is gone (VirtualRingOptions::noticing)

    bool loses_it() const { return notices != core::kNever; }
  };
  /// Tells the observers what reaches and leaves a node's blocks.
  struct ObserverTap final : core::Tap {
    ObserverTap(VirtualRing& in, NodeId at) : ring(in), node(at) {}
    void arrives(const wire::Slice& slice, Line, Time now) override {
      for (Observer* observer : ring.observers_) observer->arrives(node, slice, ring.in_ring(node, now));
    }
    void leaves(wire::ByteView slices, Line, Time) override { ring.tell_leaving(node, slices); }
    VirtualRing& ring;
    NodeId node;
  };
  /// From `since` on, by that clock itself, it is so much ahead of the ring's.
  struct ClockStep {
    Time since{};
    Duration ahead{0};

    template <class Archive>
    void archive(Archive& a) {
      a("since", since)("ahead", ahead);
    }
  };
  static constexpr std::size_t kClockSteps = 64;
  struct Node {
    std::unique_ptr<NetworkController> controller;
    Guest* guest = nullptr;  ///< in place of the controller
    bool alive = false;
    bool paused = false;
    bool cpu_reads = true;
    bool parted = false;         ///< which of two parts it is in
    std::size_t delay_line = 0;  ///< of the line into it
    std::array<Wire, 2> lines;
    std::array<End, 2> inputs, outputs;
    std::unique_ptr<ObserverTap> observer_tap;
    std::uint64_t starts = 0;
    std::vector<ClockStep> clock_steps;  ///< of its monotonic clock, the last kClockSteps
    Time stands_since = core::kNever;    ///< that clock, by the ring's
    Duration wall_ahead{0};
    std::uint32_t next_token = 1;
    std::vector<DelayLine::Arrival> waiting;  ///< what came while it was
    NodeLog log;

    template <class Archive>
    void archive(Archive& a) {
      a("controller", *controller)("alive", alive)("cpu_reads", cpu_reads)("lines", lines)("starts", starts);
      a("next_token", next_token)("paused", paused)("waiting", waiting);
      a("clock_steps", clock_steps)("stands_since", stands_since)("wall_ahead", wall_ahead);
    }
  };
  struct Action {
    Time at;
    std::uint64_t order;
    std::function<void()> what;
    bool operator>(const Action& other) const { return at != other.at ? at > other.at : order > other.order; }
  };

  core::Settings settings_of(NodeId id) const;
  std::uint64_t next_boot(NodeId id) const;
  void let_clock_go_on(NodeId id);
  void set_ahead(NodeId id, Duration ahead);
  Time before_steps(NodeId id, Time of_node) const;
  void tell_by_ring_clock(NodeId id, core::Event& event) const;
  /// @return the controller of its former life, whose boot number the new one follows; null if this is the first
  std::unique_ptr<NetworkController> make_node(NodeId id);
  Wire& wire_of(NodeId id, Line line = Line::first) { return nodes_[id].lines[static_cast<std::size_t>(line)]; }
  int next(NodeId id, Line line) const { return line == Line::first ? next_alive(id) : previous_alive(id); }
  int before(NodeId id, Line line) const { return line == Line::first ? previous_alive(id) : next_alive(id); }
  void connect(NodeId id, Line line);
  void connect_later(NodeId id, Line line);
  void disconnect_output(NodeId id, Line line);
  End& end_of(NodeId id, Line line, bool input) {
    return (input ? nodes_[id].inputs : nodes_[id].outputs)[static_cast<std::size_t>(line)];
  }
  void lose_end(NodeId id, Line line, bool input);
  void notice(NodeId id, Line line, bool input);
  void forget_ends(NodeId id);
  bool revive(NodeId id, Line line);
  Time noticed_at(NodeId id, NodeId to, Line line);
  void input_up(NodeId id, NodeId from, Line line);
  void input_lost(NodeId id, Line line);
  void output_up(NodeId id, NodeId to, Line line);
  void output_lost(NodeId id, Line line);
  void attach_input(NodeId id, NodeId from, Line line);
  void attach_output(NodeId id, NodeId to, Line line);
  void leave(NodeId id);
  void enter(NodeId id);
  bool reaches(NodeId id, NodeId other) const {
    return nodes_[other].alive && nodes_[other].parted == nodes_[id].parted;
  }
  int next_alive(NodeId id) const;
  int previous_alive(NodeId id) const;
  std::size_t delay_line_of(Duration delay);
  void touch(NodeId id) { touched_.insert(id); }
  void step();
  void act();
  void deliver(const DelayLine::Arrival& arrival);
  bool joined() const;
  void settle_touched();
  void settle(NodeId id, Node& node);
  void settle_guest(NodeId id, Node& node);
  void deliver_to_guest(const DelayLine::Arrival& arrival);
  void put_on_line(NodeId id, Line line, const Wire& out, wire::SliceWriter& slices);
  void carry_off(NodeId id, Line line, const Wire& out, wire::SliceWriter& slices);
  void tell_leaving(NodeId id, wire::ByteView slices);
  void tell_tapped(NodeId id, Line line, const wire::Slice& slice, std::size_t before);
  void pass_through_tap(NodeId id, Line line, wire::SliceWriter& slices);
  void give_out(NodeId id);

  VirtualRingOptions options_;
  Time now_{};
  std::uint64_t order_ = 0;
  std::vector<Node> nodes_;
  bool clocks_differ_ = false;  ///< a node's clock has stood, or skipped a time; else nobody need ask
  std::vector<DelayLine> delay_lines_;
  WakeTimes wakes_;
  NodeSet touched_;
  std::priority_queue<Action, std::vector<Action>, std::greater<Action>> actions_;
  std::vector<Observer*> observers_;
  wire::SliceWriter tapped_, of_guest_;
};

}  // namespace limb_ring::sim
