#pragma once

#include <array>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/journal.h"
#include "model/fold_back.h"
#include "model/packet.h"

namespace limb_ring::model {

using core::NodeState;
using core::Outcome;
using core::picoseconds;
using core::Reject;

/// A DATP or an INTP that was asked for. (protocol.md section 4)
struct Send {
  bool interrupt = false;
  core::Owner owner = core::kController;  ///< kController: a hello or a beacon
  std::uint32_t token = 0;
  int destination = 0;
  int last = 0;  ///< PRI or INT
  Bytes data;
  Time asked{};
  Time due{};  ///< after a refusal later than asked
  unsigned tries = 0;
  bool repeated = false;  ///< some try has failed by time-out or damage (protocol.md section 4.6)
  std::optional<Time> first_refusal;
  Duration back_off{0};
  bool destination_restarted = false;  ///< its refusal says nothing any more (protocol.md section 4.10)
  bool cancelled = false;              ///< its end has been told

  bool control() const { return owner == core::kController; }
  bool hello() const { return control() && data[0] == 1; }
  bool beacon() const { return control() && data[0] == 2; }
};

/// The one packet of a kind that is outstanding, or waits to be repeated. (protocol.md sections 4.1 to 4.3)
struct Flight {
  Send send;
  int sequence = 0;
  int attempt = 0;
  Packet sent;                      ///< as it went onto the line last
  Time left{};                      ///< its first byte, of the last try
  Time first_left{};                ///< ... of the first try
  std::optional<Time> waits_since;  ///< that retry waits for the line
  Time waits_until{};               ///< it waits no longer (protocol.md section 4.3)
  bool not_repeated = false;        ///< its destination has started again (protocol.md section 4.10)
};

/// Numbers of one (DID, kind). (protocol.md section 4.7)
struct Numbers {
  int next = 0;
  int without_verdict = 0;
};

/// Transmit's unit for data, or the one for interrupts.
struct Unit {
  bool interrupt = false;
  std::vector<std::deque<Send>> queues;  ///< for data: hellos and beacons, then priorities 0 to 3
  std::optional<Flight> flight;
  Time free_since{};  ///< the slot; in an open chain from when the next may leave
  std::map<int, Numbers> numbers;
};

/// What was decided of a source's numbers. (protocol.md section 4.10)
struct Decided {
  int sequence = 0;
  bool taken = false;
  Time when{};
  bool retries_only = false;
  bool on_former_input = false;
  bool before_starting_over = false;
};
struct Page {
  int incarnation = 0;
  std::optional<std::uint64_t> boot;
  bool begun_by_packet = false;
  std::map<std::pair<bool, bool>, Decided> decided;  ///< by (interrupt, broadcast)
};

/// A DATP in the insertion buffer. (protocol.md section 2.5)
struct Relayed {
  Bytes bytes;
  bool complete = false, broken = false;
  Time since{};      ///< its header was in
  Time header_at{};  ///< its header may leave
  Time end_at{};     ///< its odd bytes, trailer and CRC may leave
};
struct RelayedInterrupt {
  Bytes bytes;
  Time since{}, leaves_at{};
};

/// The DATP that is coming in.
struct Incoming {
  enum class Fate { own, not_received, received_only, passed_on } fate = Fate::not_received;
  Bytes bytes;
  Time heard{};  ///< its last slice
  std::shared_ptr<Relayed> relayed;
};

/// The DATP that is going out.
struct Outgoing {
  std::shared_ptr<Relayed> relayed;  ///< null: an own one
  Bytes own;
  std::size_t given = 0;
  Time header_left{};     ///< the last bit of its header
  Time grid{};            ///< from here on word boundaries are counted
  unsigned embedded = 0;  ///< INTPs

  const Bytes& bytes() const { return relayed ? relayed->bytes : own; }
  bool complete() const { return !relayed || relayed->complete; }
};

/// What is known of another node. (protocol.md section 8.2)
struct Peer {
  std::uint64_t boot = 0;
  std::optional<wire::Beacon> beacon;
  Time heard{};
  std::optional<Time> folds_until;  ///< its input or output is folded, as far as is known (protocol.md section 8.12)
};

struct Break {
  int before = 0, behind = 0;
};

/// One of the NC's lines, as it is told of them.
struct NcLine {
  bool up = false, was_up = false;
  bool folded = false;  ///< the second line stands for it
  int neighbour = 0;
  bool lost_since_home = false;
};

class Node : private BehindFold {
 public:
  Node(const core::Settings& settings, Time now);
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  void apply(const core::Input& input, Time now);
  /// When it does something by itself; kNever: not before the next input.
  Time next_deadline(Time now) const;

  /// @name What has come out, taken by whoever compares
  ///@{
  std::array<std::vector<Given>, 2> given;
  std::vector<core::Event> events;
  std::array<std::deque<core::ReceivedPacket>, 4> packets;
  ///@}
  /// The packet that its CPU gets next.
  core::ReceivedPacket* next_packet(Time now);
  /// Its state, and what waits in it.
  std::string in_words() const;

 private:
  // -- node.cpp
  void input_up(int from, Time now);
  void input_lost(Time now);
  void input_is_another();
  void input_gap(Time now);
  void output_up(int to, Time now);
  void output_lost(Time now);
  void receive(const Given& slice, Time now);
  std::size_t output_line() const { return fold_ && fold_->turned_back() ? 1 : 0; }
  void timers(Time now);
  void run(Time now);
  void tell(Time at, decltype(core::Event::what) what);
  unsigned count_nodes() const { return static_cast<unsigned>(settings_.order.size()); }
  /// Lines from one node to another in ring order.
  unsigned distance(int from, int to) const;
  bool configured(int id) const;
  int id() const { return settings_.id; }
  Duration try_timeout() const;
  Duration worst_lap() const;

  // -- behind_fold.cpp: protocol.md sections 8.9 to 8.12
  void line(const core::Input& what, Time now);
  void folded_line(const core::Input& what, Time now);
  void lines_are(const Lines& lines, Time now) override;
  void fold_changed(Time now);
  void input_breaks(Time now) override { input_gap(now); }
  void output_breaks(Time now) override { drop_output(now); }
  void slice_comes(const Given& slice, Time now) override { receive(slice, now); }
  bool is_mid_packet() const override { return outgoing_.has_value(); }
  bool takes(const Given& slice) const override;
  void look_for_folds(Time now);
  bool grows_together(const Packet& home, Time now);

  // -- relay.cpp: protocol.md sections 2.2, 2.6
  Incoming::Fate fate_of(const Bytes& header, bool interrupt, Time now);
  void datp_begins(const Bytes& bytes, Time now);
  void datp_ends(Time now, bool at_once = false);
  void whole_datp(Incoming& in, bool at_once, Time now);
  void break_off_input(Time now);
  void intp(const Bytes& bytes, Time now);
  bool bypasses(int source) const;
  bool cut_off(int source) const;
  std::size_t insertion_bytes() const;
  Duration behind(std::size_t bytes) const;

  // -- receive.cpp: protocol.md sections 2.3, 3.5, 4.10, 5.3
  bool addressed(const Packet& packet) const;
  int answer(const Packet& packet, Time at, Time now);
  int answer_control(const Packet& packet, Time at, Time now);
  int answer_data(const Packet& packet, Time at, Time now);
  int answer_interrupt(const Packet& packet, Time at, Time now);
  Page* page_for(const Packet& packet, std::uint64_t boot_if_own);
  bool is_unheard_nodes_retry(const Packet& packet) const;
  bool is_unaware_nodes_retry(const Packet& packet, Time at) const;
  Decided* known(Page& page, const Packet& packet, Time now);
  bool is_doubtful(const Decided& decided, Time now) const;
  unsigned free_buffers(int priority) const;

  // -- transmit.cpp: protocol.md section 4
  void ask(const core::SendRequest& request, Time now);
  void ask(const core::InterruptRequest& request, Time now);
  void pull(core::Owner owner, std::uint32_t token, unsigned input, Time now);
  void enqueue(Unit& unit, std::size_t queue, Send send, Time now, Reject reject);
  void end(Send& send, Outcome outcome, Reject reject, Duration round_trip, Time at);
  void cancel(core::Owner owner, Time now);
  void cancel_all(Time now);
  void end_flight(Unit& unit, Outcome outcome, Duration round_trip, Time at, bool verdict);
  void try_failed(Unit& unit, Time at);
  void returned(const Packet& packet, Time at, Time now);
  void refused(Unit& unit, Time at);
  std::optional<std::size_t> choose(const Unit& unit, Time now) const;
  std::optional<Time> own_since(const Unit& unit) const;
  bool may_go(const Send& send) const;
  Packet launch(Unit& unit, Time now);
  void unit_timers(Unit& unit, Time now);
  Time unit_deadline(const Unit& unit) const;
  void destination_restarted(int source, Time now);
  void end_refused_head(std::deque<Send>& queue, Outcome outcome, Time at);
  void end_unconfirmed(Time now);

  // -- packet_manager.cpp: protocol.md sections 2.4, 2.5, 5.2, 6.4
  void step(Time now);
  bool step_once(Time now);
  struct Next {
    enum What { nothing, own_intp, relayed_intp, own_datp, relayed_datp, tail, abort };
    Next(Time when = kNever, What does = nothing) : at(when), what(does) {}
    Time at;
    What what;
  };
  Next next_step(Time now) const;
  Next next_interrupt(Time free) const;
  Next next_datp(Time free) const;
  Next next_end(Time free) const;
  Time embedded_at(Time ready, const Next& end) const;
  void give_words(Time now);
  void give_interrupt(bool own, Time now);
  void give_start(bool own, Time now);
  void give_end(SliceKind kind, Time now);
  void give(SliceKind kind, const Bytes& bytes);
  void drop_output(Time now);

  // -- membership.cpp: protocol.md sections 4.7, 4.8, 8.1 to 8.6
  void lines_changed(Time now);
  void set_state(NodeState state, Time now);
  bool closed() const;
  NodeState closed_state() const;
  void reconsider_closed(Time now);
  void say_hello(bool remembers, Time now);
  void hello_again(Time now);
  void control_ended(const Send& send, Outcome outcome, Time now);
  void own_home(const Packet& packet, Time at, Time now);
  void control_home_unmatched(const Packet& packet, Time at);
  void heard(const Packet& packet, const std::optional<wire::Hello>& hello, const std::optional<wire::Beacon>& beacon,
             Time at, Time now);
  void heard_break(int source, const wire::Beacon& beacon, Time at);
  void break_known(Break known, bool own, bool folded, Time now);
  void own_break_ends();
  void watch_for_break(Time now);
  void start_over(Time now);
  void forget_former_input(Time now);
  /// Two parts of the ring may each be closed for a while. (protocol.md section 4.10)
  bool falls_into_parts() const { return settings_.fold_back || settings_.several_hosts; }
  void sign_of_duplicate(Time now);
  void joined(Time at);
  void membership_timers(Time now);
  Time membership_deadline() const;
  void want_beacon() { beacon_wanted_ = true; }
  bool may_say_beacon() const;
  Duration beacon_takes_longer() const;
  void beacons(Time now);
  void beacon_period_over(Time now);
  wire::Beacon beacon_now(Time now) const;
  void new_hello_when_due(Time now);
  bool both_up() const { return in_.up && out_.up; }

  core::Settings settings_;
  Time now_{};

  NcLine in_, out_;
  std::optional<FoldBack> fold_;
  bool fold_known_ = false;
  std::optional<Time> fold_known_at_;  ///< last
  std::array<bool, 2> ready_{true, true};

  std::optional<Incoming> incoming_;
  std::deque<std::shared_ptr<Relayed>> relayed_;
  std::deque<RelayedInterrupt> relayed_interrupts_;
  std::optional<Outgoing> outgoing_;
  Time line_free_{};  ///< the part that is on the line has left

  bool cpu_present_ = true;
  core::CpuReport cpu_;
  std::map<int, Page> pages_;

  Unit data_, interrupts_;
  bool new_hello_wanted_ = false;
  bool grown_together_ = false;  ///< out of two parts: nothing is confirmed until the new hello is said

  NodeState state_ = NodeState::starting;
  std::uint64_t boot_, first_boot_;
  unsigned ring_size_ = 0;
  int signs_ = 0;
  bool hello_out_ = false;  ///< it waits, or is outstanding, or will be said again
  Time hello_said_{};
  Time hello_due_ = kNever;       ///< it has ended lost, and is said again then
  Time announced_at_ = kNever;    ///< the own hello, or a beacon of this boot number, first came home
  bool hello_left_ = true;        ///< in an open chain: nothing else goes before
  bool hello_remembers_ = false;  ///< the node has joined before, and goes on receiving
  bool beacon_out_ = false;
  bool beacon_wanted_ = false;
  Time allowed_since_{};
  Time beacon_at_ = kNever, break_at_ = kNever, drained_at_ = kNever;
  std::optional<Break> break_;
  bool break_is_own_ = false;
  std::map<int, Peer> peers_;
};

}  // namespace limb_ring::model
