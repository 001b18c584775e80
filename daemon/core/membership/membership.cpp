#include "core/membership/membership.h"

#include <algorithm>

namespace limb_ring::core {
namespace {

constexpr std::uint32_t kHelloToken = 1;
constexpr std::uint32_t kBeaconToken = 2;
/// So many hellos and beacons with the own id, but not of this node, mean a duplicate id. Leftovers of the time before
/// a restart pass only once; a living double goes on sending.
constexpr unsigned kDoubledSigns = 3;

wire::LinkState link_state(bool up, bool lost, bool folded) {
  if (up && folded) return wire::LinkState::folded;
  return up ? wire::LinkState::up : lost ? wire::LinkState::silent : wire::LinkState::down;
}

}  // namespace

Membership::Membership(const Settings& settings, Transmit& transmit, Receive& receive, DuplicateMemory& memory,
                       Counters& counters, EventQueue& events)
    : settings_(settings),
      transmit_(transmit),
      receive_(receive),
      memory_(memory),
      counters_(counters),
      events_(events),
      boot_(settings.boot) {
  transmit_.restart_numbers(boot_);
}

void Membership::enter(NodeState state, Time now) {
  if (state == state_) return;
  events_.put(now, StateChanged{state_, state});
  state_ = state;
}

// ---- links --------------------------------------------------------------------------------

void Membership::input_up(NodeId from, Time now) {
  if (input_ == Link::up) input_lost(now);
  input_ = Link::up;
  input_from_ = from;
  break_due_ = kNever;
  if (break_known_ && break_behind_ == settings_.id) break_known_ = false;
  links_changed(now);
}

void Membership::input_lost(Time now) {
  if (input_ != Link::up) return;
  input_ = Link::lost;
  input_was_lost_ = true;
  links_changed(now);
}

void Membership::output_up(NodeId to, Time now) {
  if (output_ == Link::up) output_lost(now);
  output_ = Link::up;
  output_to_ = to;
  links_changed(now);
}

void Membership::output_lost(Time now) {
  if (output_ != Link::up) return;
  output_ = Link::lost;
  output_was_lost_ = true;
  links_changed(now);
}

// Both links gone or replaced: this node was bypassed; perhaps it was only frozen. What it knows of the others, and
// they of it, is out of date. (ours, protocol.md section 4.8)
void Membership::links_changed(Time now) {
  if (input_was_lost_ && output_was_lost_) start_over(now);
  watch_for_break(now);
  if (state_ == NodeState::starting || state_ == NodeState::joining || state_ == NodeState::doubled_id) {
    if (links_up()) say_hello(now);
  } else {
    change(now);
  }
}

void Membership::start_over(Time now) {
  input_was_lost_ = output_was_lost_ = false;
  transmit_.set_open_chain(false, now);
  new_life(now);
  peers_.forget_all();
  ring_size_ = 0;
  enter(NodeState::starting, now);
}

// Sends end cancelled, and everything is as after a start, until the next hello is home.
void Membership::new_life(Time now) {
  transmit_.restart(now);
  transmit_.set_gate(Gate::closed, now);
  memory_.start_over(now);
  receive_.set_joining(true);
  hello_out_ = renumbering_ = merged_ = beacon_out_ = break_known_ = false;
  beacon_due_ = break_due_ = drained_at_ = kNever;
  next_boot();
}

// A new incarnation: its packets say so, and its sequence numbers begin anew.
void Membership::next_boot() {
  ++boot_;
  transmit_.restart_numbers(boot_);
  memory_.meet_hello(settings_.id, boot_);  // packets to oneself
}

// ---- hello --------------------------------------------------------------------------------

void Membership::say_hello(Time now) {
  if (hello_out_) transmit_.restart(now);
  hello_out_ = true;
  ++counters_.hellos;
  transmit_.set_gate(Gate::control, now);
  std::array<std::uint8_t, wire::kHelloSize> bytes;
  wire::encode(wire::Hello{boot_, renumbering_}, bytes.data());
  transmit_.data.enqueue_control({bytes.data(), bytes.size()}, kHelloToken, now);
  if (state_ == NodeState::starting) enter(NodeState::joining, now);
}

void Membership::hello_ended(const SendEnded& ended, Time now) {
  hello_out_ = false;
  const bool home = ended.outcome == Outcome::delivered || ended.outcome == Outcome::no_such_node ||
                    ended.outcome == Outcome::refused;
  if (home || state_ == NodeState::open_chain) return joined(now);
  if (links_up()) return say_hello(now);
  if (state_ == NodeState::joining) enter(NodeState::starting, now);
}

void Membership::joined(Time now) {
  renumbering_ = false;
  receive_.set_joining(false);
  memory_.forget_aged();
  transmit_.set_gate(Gate::open, now);
  if (state_ != NodeState::open_chain) enter(settled_state(), now);
  change(now);
}

// Sequence numbers are used up without a verdict: everyone is told to forget them. (ours, protocol.md section 4.7)
void Membership::renumber(Time now) {
  if (!renumbering_) transmit_.set_gate(Gate::closed, now);
  renumbering_ = true;
  if (!transmit_.idle()) return;
  transmit_.data.drop_control();  // nothing goes before the hello; its beacon follows it
  beacon_out_ = hello_out_ = false;
  merged_ = false;
  next_boot();
  say_hello(now);
}

void Membership::control_ended(Time now) {
  SendEnded ended;
  while (transmit_.data.take_control_end(ended)) {
    if (ended.token == kHelloToken) {
      hello_ended(ended, now);
    } else {
      beacon_out_ = false;
      if (ended.outcome == Outcome::delivered) events_.put(now, BeaconHome{ended.round_trip});
      if (beacon_wanted_) send_beacon(now);
    }
  }
}

void Membership::renumber_when_settled(Time now) {
  if (settled() && !hello_out_) renumber(now);
}

// ---- what comes home ----------------------------------------------------------------------

void Membership::came_home(std::uint8_t hop, Time now) {
  input_was_lost_ = input_ != Link::up;
  output_was_lost_ = output_ != Link::up;
  doubled_signs_ = 0;
  if (!hello_out_ && has_merged(hop, now)) merged_ = true;
  ring_size_ = hop + 1u;
  if (state_ == NodeState::doubled_id) enter(NodeState::joining, now);
  if (settled()) enter(settled_state(), now);
}

void Membership::own_seen(const wire::PacketFields& packet, bool matched, Time now) {
  if (!matched && ring_size_ != 0 && packet.hop() + 1u != ring_size_) ++counters_.doubled_id_signs;
  if (!is_control(packet)) return;
  if (const auto hello = wire::decode_hello(packet.data())) own_control_seen(hello->boot, packet.hop(), now);
  if (const auto beacon = wire::decode_beacon(packet.data())) own_control_seen(beacon->boot, packet.hop(), now);
}

void Membership::own_control_seen(std::uint64_t boot, std::uint8_t hop, Time now) {
  if (boot == boot_) {
    if (state_ != NodeState::open_chain) return;
    ring_size_ = hop + 1u;
    drained_at_ = std::min(drained_at_, now + settings_.send_timeout());
    return;
  }
  if (boot >= settings_.boot && boot < boot_) return;  // of this process, before its last new hello
  ++counters_.doubled_id_signs;
  const bool can_tell = state_ != NodeState::starting && state_ != NodeState::doubled_id;
  if (++doubled_signs_ >= kDoubledSigns && can_tell) found_double(now);
}

// The two nodes take each other's packets off the ring, so nothing is confirmed. This one goes on saying hello; when
// one comes home, the other node is gone. (ours, protocol.md section 8.6)
void Membership::found_double(Time now) {
  transmit_.set_open_chain(false, now);
  new_life(now);
  enter(NodeState::doubled_id, now);
  if (links_up()) say_hello(now);
}

// ---- the others ---------------------------------------------------------------------------

bool Membership::heard(const wire::PacketFields& packet, Time now) {
  if (const auto hello = wire::decode_hello(packet.data())) return heard_hello(packet, *hello, now);
  if (const auto beacon = wire::decode_beacon(packet.data())) return heard_beacon(packet, *beacon, now);
  ++counters_.control_malformed;
  return true;
}

bool Membership::heard_hello(const wire::PacketFields& packet, const wire::Hello& hello, Time now) {
  const NodeId source = packet.source();
  const Peer& peer = peers_[source];
  const bool goes_on = hello.remembers && peer.known && hello.boot == peer.boot + 1;  // no start was missed
  if (!memory_.meet_hello(source, hello.boot)) return ++counters_.earlier_incarnation, false;
  // It no longer knows what it took of us.
  if (peers_.heard_hello(source, packet.hop(), hello, now) && !goes_on) transmit_.forgotten_by(source, now);
  return true;
}

// In an open chain a hello can be missed; the boot number in later beacons still tells of the restart. The first beacon
// of a node is no sign of one. (ours, protocol.md section 4.10)
bool Membership::heard_beacon(const wire::PacketFields& packet, const wire::Beacon& beacon, Time now) {
  const NodeId source = packet.source();
  if (!memory_.meet_beacon(source, beacon.boot, now)) return ++counters_.earlier_incarnation, false;
  if (peers_[source].known && peers_[source].boot != beacon.boot) transmit_.forgotten_by(source, now);
  if (peers_.heard_beacon(source, packet.hop(), beacon, now)) events_.put(now, PeerChanged{source});
  if (beacon.break_known && beacon.break_behind == source) hear_break(beacon, now);
  if (!beacon.break_known && break_behind_ == source && state_ != NodeState::open_chain) break_known_ = false;
  look_for_folds(now);
  return true;
}

void Membership::set_cpu(const CpuReport& report, Time now) {
  const bool news = report.boots != cpu_.boots || report.state != cpu_.state;
  cpu_ = report;
  if (news && accepts_sends()) change(now);
}

wire::Beacon Membership::beacon(Time now) const {
  wire::Beacon b;
  b.boot = boot_;
  b.cpu_boots = cpu_.boots;
  b.cpu_state = cpu_.state;
  b.cpu_comes_back = cpu_.comes_back;
  const auto silent = std::chrono::duration_cast<std::chrono::milliseconds>(now - cpu_.spoke_at).count();
  b.cpu_silent_ms = static_cast<std::uint32_t>(std::clamp<std::int64_t>(silent, 0, UINT32_MAX));
  b.input = link_state(input_ == Link::up, input_ == Link::lost, input_folded_);
  b.input_from = input_from_;
  b.output = link_state(output_ == Link::up, output_ == Link::lost, output_folded_);
  b.output_to = output_to_;
  b.break_known = break_known_;
  b.break_before = break_before_;
  b.break_behind = break_behind_;
  return b;
}

// Something that beacons say has changed: say it at once.
void Membership::change(Time now) {
  if (settings_.beacon.count() == 0) return;
  if (beacon_out_)
    beacon_wanted_ = true;
  else
    send_beacon(now);
}

void Membership::send_beacon(Time now) {
  beacon_wanted_ = false;
  beacon_due_ = now + settings_.beacon;
  if (hello_out_ || !accepts_sends()) return;
  beacon_out_ = true;
  std::array<std::uint8_t, wire::kBeaconSize> bytes;
  wire::encode(beacon(now), bytes.data());
  transmit_.data.enqueue_control({bytes.data(), bytes.size()}, kBeaconToken, now);
}

// ---- time ---------------------------------------------------------------------------------

void Membership::act_on_time(Time now) {
  if (break_due_ <= now) own_input_broken(now);
  if (drained_at_ <= now) leave_open_chain(now);
  if (beacon_due_ <= now) {
    beacon_due_ = now + settings_.beacon;
    change(now);
    look_for_folds(now);
  }
}

}  // namespace limb_ring::core
