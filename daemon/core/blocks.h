#pragma once

#include "core/line.h"
#include "core/relay/relay.h"

namespace limb_ring::core {

/// Sees each packet once, on whichever line it comes and goes, but not what the node only repeats on the second. (ours)
class Tap {
 public:
  virtual ~Tap() = default;
  /// Before the blocks take a slice.
  virtual void arrives(const wire::Slice&, Line, Time) {}
  /// What the blocks have given out, framed.
  virtual void leaves(wire::ByteView framed_slices, Line, Time) = 0;
};

/// The blocks of a network controller, wired: Relay, Transmit, Packet Manager, Receive (paper), pins and interrupt
/// inputs (paper), membership (ours), between one line in and one line out. The fold decides which lines of the node
/// these are; everybody else uses network_controller.h.
class Blocks {
 public:
  explicit Blocks(const Settings& settings);
  Blocks(const Blocks&) = delete;
  Blocks& operator=(const Blocks&) = delete;

  /// @name The lines
  ///@{
  /// @param folded true: the second line stands for the input, or the output
  void input_up(NodeId from, Time now, bool folded = false);
  void input_lost(Time now);
  /// Something was lost on the input: a DATP that is coming in will never be whole.
  void input_gap(Time now) {
    own_changes();
    relay_.input_gap(now);
    settle(now);
  }
  void output_up(NodeId to, Time now, bool folded = false);
  void output_lost(Time now);
  /// The output goes on over another line to the same node: what waited for the old one is dropped. (ours,
  /// protocol.md section 2.6)
  void output_replaced(Time now);
  /// The neighbours on the first line, also while the second line stands for it. Nodes between this one and
  /// `successor` are bypassed. (ours, protocol.md section 8.9)
  void set_neighbours(NodeId before, NodeId next, NodeId successor);
  /// Whether the second line stands for input and output; beacons tell it. (ours, protocol.md section 8.12)
  void set_folded(bool input, bool output, Time now) {
    own_changes();
    membership_.set_folded(input, output, now);
  }
  /// What comes in was turned back at `node`; nothing: the input is the first line. (ours, protocol.md section 4.9)
  void set_turned_back_at(std::optional<NodeId> node) { relay_.set_turned_back_at(node); }
  /// line() holds something.
  bool has_given_out() const { return !line_.empty(); }
  /// A DATP is on the line and not yet through, or waits in line().
  bool is_mid_packet() const { return has_given_out() || packet_manager_.is_open(); }
  /// Another DATP of the largest size could come in.
  bool has_room() const { return packet_manager_.has_room(); }
  void set_output_ready(bool ready) { packet_manager_.set_ready(ready); }
  /// One slice from upstream. @param on for the tap: the line that it came on
  void receive(Line on, const wire::Slice& slice, Time now);
  /// The node takes nothing from that packet, which has a good CRC, and does not look at its data.
  bool only_passes(const wire::PacketFields& packet) const { return !receive_.heeds(packet); }
  /// Slices for downstream; the caller writes and clears them.
  wire::SliceWriter& line() { return line_; }
  /// From now on `tap` sees the packets; null: no tap.
  void set_tap(Tap* tap) { tap_ = tap; }
  /// Shows the tap what is in line(), which leaves on that one.
  void show_given_out(Line on, Time now) {
    if (tap_ != nullptr && !line_.empty()) tap_->leaves(line_.view(), on, now);
  }
  ///@}

  /// @name The CPU and its helpers. Every call ends in exactly one SendEnded event.
  ///@{
  void send(const SendRequest& request, Time now) {
    own_changes();
    transmit_.send(request, membership_.accepts_sends(), now);
  }
  void interrupt(const InterruptRequest& request, Time now) {
    own_changes();
    transmit_.interrupt(request, membership_.accepts_sends(), now);
  }
  /// Pulls interrupt input 0..7: sends the INTP it is wired to, without the CPU. (paper, protocol.md section 5.4)
  void pull(Owner owner, std::uint32_t token, unsigned input, Time now) {
    own_changes();
    transmit_.pull(owner, token, input, membership_.accepts_sends(), now);
  }
  void cancel(Owner owner, Time now) {
    own_changes();
    transmit_.cancel(owner, now);
  }
  ///@}

  /// @name The CPU's state
  ///@{
  /// Next packet for the CPU, by priority. @return false if none is due
  bool take(Time now, ReceivedPacket& out) {
    own_changes();
    return receive_.take(now, out);
  }
  void set_cpu_present(bool present) { receive_.set_cpu_present(present); }
  void set_cpu(const CpuReport& report, Time now) {
    own_changes();
    membership_.set_cpu(report, now);
  }
  /// The CPU was reset: empties its send queue and the receive buffers. (ours, protocol.md section 5.5)
  void cpu_reset(Owner cpu, Time now);
  ///@}

  /// @name Time and events
  ///@{
  void handle_timeout(Time now);
  void run(Time now);
  /// When handle_timeout(), run(), take_event() or take() have something new to do, if nothing else
  /// happens before.
  Time next_deadline(Time now) const;
  /// take_event() or take() has something.
  bool has_output(Time now) const { return events_.is_due(now) || receive_.is_due(now); }
  /// Needs no own_changes(): own_deadline() looks anew anyway while something is due.
  bool take_event(Time now, Event& out) { return events_.take(now, out); }
  ///@}

  const Settings& settings() const { return settings_; }
  const Counters& counters() const { return counters_; }
  Counters& counters() { return counters_; }
  const Membership& membership() const { return membership_; }
  std::size_t received_waiting() const { return receive_.waiting(); }
  std::size_t received_waiting(wire::Priority priority) const { return receive_.waiting(priority); }
  const InsertionBuffer& insertion_buffer() const { return packet_manager_.insertion_buffer(); }

  /// See archive.h. @pre to read: made with the same settings, and without any input so far
  template <class Archive>
  void archive(Archive& a) {
    own_changes();
    a("counters", counters_)("events", events_)("line", line_)("transmit", transmit_)("memory", memory_);
    a("membership", membership_)("receive", receive_)("packet_manager", packet_manager_)("relay", relay_);
  }

 private:
  /// Most packets only pass: they change nothing of Transmit, Receive, membership and events. So what these have to do
  /// is kept until something else happens. Whatever may change it calls this.
  void own_changes() {
    own_deadline_ = Time::min();
    settled_ = false;
  }
  /// Their part of next_deadline().
  Time own_deadline(Time now) const {
    if (own_deadline_ <= now) own_deadline_ = find_own_deadline(now);
    return own_deadline_;
  }
  Time find_own_deadline(Time now) const;
  /// After every input: membership settles what it has changed. An end of a send decides what may go onto the line, so
  /// that comes before put_onto_line().
  void settle(Time now) {
    if (!settled_) settle_changes(now);
  }
  void settle_changes(Time now);
  void put_onto_line(Time now) {
    if (packet_manager_.run(now)) own_changes();
  }

  // What every hop reads lies together, what few read behind it: a large ring does not fit into a cache. (The members
  // know each other by reference alone, but for the settings, and Transmit, which membership sets up.)
  const Settings settings_;
  mutable Time own_deadline_ = Time::min();  ///< holds while it is not reached
  bool settled_ = false;                     ///< membership has settled what has changed
  Tap* tap_ = nullptr;
  EventQueue events_;
  wire::SliceWriter line_;
  Receive receive_;
  PacketManager packet_manager_;
  Transmit transmit_;
  Relay relay_;
  Pins pins_;
  Returns returns_;
  Membership membership_;
  Counters counters_;
  DuplicateMemory memory_;
};

}  // namespace limb_ring::core
