// A node's place in the ring: protocol.md sections 4.7, 4.8, 8.1 to 8.6, and 8.12.
#include <algorithm>

#include "model/node.h"

namespace limb_ring::model {

bool Node::closed() const {
  return state_ == NodeState::up || state_ == NodeState::alone || state_ == NodeState::folded;
}

NodeState Node::closed_state() const {
  if (ring_size_ == 1) return NodeState::alone;
  return fold_known_ ? NodeState::folded : NodeState::up;
}

void Node::set_state(NodeState state, Time now) {
  if (state == state_) return;
  for (core::Event& event : events)  // told with the next change at the latest (protocol.md section 6.4)
    if (std::holds_alternative<core::StateChanged>(event.what)) event.at = std::min(event.at, now);
  tell(now, core::StateChanged{state_, state});
  state_ = state;
}

void Node::reconsider_closed(Time now) {
  if (closed()) set_state(closed_state(), now);
}

// ---- lines ----------------------------------------------------------------------------------------

void Node::lines_changed(Time now) {
  if (in_.lost_since_home && out_.lost_since_home) return start_over(now);
  if (both_up() && (state_ == NodeState::starting)) {
    set_state(NodeState::joining, now);
    say_hello(false, now);
  } else if (both_up() && (state_ == NodeState::joining || state_ == NodeState::duplicate_id)) {
    cancel_all(now);
    say_hello(false, now);
  }
  want_beacon();
  beacons(now);
}

// protocol.md section 4.8.
void Node::start_over(Time now) {
  announced_at_ = kNever;
  cancel_all(now);
  new_hello_wanted_ = grown_together_ = false;
  peers_.clear();
  ring_size_ = 0;
  signs_ = 0;
  ++boot_;
  data_.numbers.clear();
  interrupts_.numbers.clear();
  in_.lost_since_home = out_.lost_since_home = false;
  break_.reset();
  break_is_own_ = false;
  break_at_ = drained_at_ = beacon_at_ = kNever;
  hello_due_ = kNever;
  beacon_wanted_ = false;
  forget_former_input(now);
  set_state(NodeState::starting, now);
}

// protocol.md section 4.10.
void Node::forget_former_input(Time now) {
  for (auto& [source, page] : pages_)
    for (auto entry = page.decided.begin(); entry != page.decided.end();) {
      const bool old = now - entry->second.when > try_timeout();
      const bool forgotten = falls_into_parts() ? old : entry->second.on_former_input;
      entry->second.before_starting_over = falls_into_parts();
      entry = forgotten ? page.decided.erase(entry) : std::next(entry);
    }
}

// ---- hello ------------------------------------------------------------------------------------------

void Node::say_hello(bool remembers, Time now) {
  Send send;
  send.destination = kAll;
  send.last = 1 << 2;
  send.data.resize(wire::kHelloSize);
  wire::encode(wire::Hello{boot_, remembers}, send.data.data());
  send.asked = send.due = now;
  data_.queues[0].push_back(send);
  hello_out_ = true;
  hello_left_ = false;
  hello_remembers_ = remembers;
  hello_said_ = now;
  hello_due_ = kNever;
}

/// It has ended lost or rejected, some time ago or now. (protocol.md section 8.1)
void Node::hello_again(Time now) {
  hello_due_ = kNever;
  hello_out_ = false;
  if (state_ == NodeState::joining && !both_up()) return set_state(NodeState::starting, now);
  if (both_up())
    say_hello(closed(), now);
  else
    new_hello_wanted_ = closed();
}

/// A hello or beacon has ended otherwise than by coming home, or has left into an open chain.
void Node::control_ended(const Send& send, Outcome outcome, Time now) {
  if (send.beacon()) {
    beacon_out_ = false;
    return beacons(now);
  }
  if (!hello_out_) return beacons(now);  // it is home, whatever its FBC (protocol.md section 4.8)
  const bool lost = outcome == Outcome::lost || outcome == Outcome::rejected;
  if (lost && now < hello_said_ + try_timeout()) {
    hello_due_ = hello_said_ + try_timeout();
    return;
  }
  if (lost) return hello_again(now);
  hello_out_ = false;
  // What waited for it waits for the line from now on; it waited itself since it was said. (protocol.md section 2.4)
  if (outcome == Outcome::unconfirmed) hello_left_ = true, allowed_since_ = now;
  beacons(now);
}

// protocol.md section 4.7.
void Node::new_hello_when_due(Time now) {
  if (!new_hello_wanted_ || !closed() || hello_out_) return;
  if (data_.flight || interrupts_.flight) return;
  new_hello_wanted_ = grown_together_ = false;
  auto& control = data_.queues[0];
  for (const Send& send : control)
    if (send.beacon()) beacon_out_ = false;
  control.clear();
  ++boot_;
  data_.numbers.clear();
  interrupts_.numbers.clear();
  say_hello(true, now);
}

// ---- what comes home ----------------------------------------------------------------------------------

void Node::own_home(const Packet& packet, Time at, Time now) {
  ring_size_ = static_cast<unsigned>(packet.hop()) + 1;
  signs_ = 0;
  for (NcLine* line : {&in_, &out_}) line->lost_since_home = line->was_up && !line->up;
  const Send& send = data_.flight ? data_.flight->send : interrupts_.flight->send;
  const bool hello = !packet.interrupt() && send.hello();
  const bool beacon = !packet.interrupt() && send.beacon();
  if (state_ == NodeState::duplicate_id) set_state(NodeState::joining, now);
  if (hello || beacon) announced_at_ = std::min(announced_at_, at);
  if (hello) {
    hello_out_ = false;
    hello_left_ = true;
    if (state_ == NodeState::joining)
      joined(now);
    else
      want_beacon();  // the boot number is a new one
    allowed_since_ = now;
  }
  if (beacon && packet.fbc() != 0xFF && packet.fbc() != 0) tell(now, core::BeaconHome{at - data_.flight->left});
  reconsider_closed(at);
}

void Node::joined(Time now) {
  pages_.erase(id());
  set_state(closed_state(), now);
  allowed_since_ = now;
  want_beacon();
}

void Node::control_home_unmatched(const Packet& packet, Time at) {
  if (!packet.control()) return;
  const Bytes data = packet.data();
  const auto hello = wire::decode_hello({data.data(), data.size()});
  const auto beacon = wire::decode_beacon({data.data(), data.size()});
  if (!hello && !beacon) return;
  const std::uint64_t boot = hello ? hello->boot : beacon->boot;
  if (boot < first_boot_ || boot > boot_) return sign_of_duplicate(at);
  if (boot == boot_) announced_at_ = std::min(announced_at_, at);
  if (state_ != NodeState::open_chain || boot != boot_) return;
  ring_size_ = static_cast<unsigned>(packet.hop()) + 1;
  for (NcLine* line : {&in_, &out_}) line->lost_since_home = line->was_up && !line->up;
  if (drained_at_ == kNever) drained_at_ = at + try_timeout();
}

// protocol.md section 8.6.
void Node::sign_of_duplicate(Time now) {
  if (++signs_ < 3 || state_ == NodeState::starting || state_ == NodeState::duplicate_id) return;
  signs_ = 0;
  announced_at_ = hello_due_ = kNever;
  cancel_all(now);
  new_hello_wanted_ = grown_together_ = false;
  ++boot_;
  data_.numbers.clear();
  interrupts_.numbers.clear();
  beacon_at_ = kNever;
  set_state(NodeState::duplicate_id, now);
  if (both_up()) say_hello(false, now);
}

// ---- what others say: protocol.md sections 4.10, 8.2 and 8.3 --------------------------------------------------------

void Node::heard(const Packet& packet, const std::optional<wire::Hello>& hello,
                 const std::optional<wire::Beacon>& beacon, Time at, Time now) {
  const int source = packet.source();
  const std::uint64_t boot = hello ? hello->boot : beacon->boot;
  const auto known = peers_.find(source);
  const bool first = known == peers_.end();
  const bool other = first ? hello.has_value() : known->second.boot != boot;
  const bool goes_on = hello && hello->remembers && !first && boot == known->second.boot + 1;
  if (other && !goes_on) destination_restarted(source, at);
  Peer& peer = peers_[source];
  peer.boot = boot;
  peer.heard = now;
  if (hello) return;
  const auto& before = peer.beacon;
  const bool news = !before || before->boot != beacon->boot || before->cpu_boots != beacon->cpu_boots ||
                    before->cpu_state != beacon->cpu_state || before->input != beacon->input ||
                    before->input_from != beacon->input_from || before->output != beacon->output ||
                    before->output_to != beacon->output_to || before->break_known != beacon->break_known;
  peer.beacon = beacon;
  const bool folds = beacon->input == wire::LinkState::folded || beacon->output == wire::LinkState::folded;
  if (folds)
    peer.folds_until = at + 5 * settings_.beacon;
  else
    peer.folds_until.reset();
  if (news) tell(at, core::PeerChanged{wire::NodeId{static_cast<std::uint8_t>(source)}});
  heard_break(source, *beacon, at);
  look_for_folds(at);
  // They go round together. (protocol.md section 8.2)
  const Duration soon = settings_.beacon / 2 + beacon_takes_longer();
  if (!beacon_out_ && !hello_out_ && beacon_at_ != kNever && beacon_at_ - at <= soon) want_beacon();
  beacons(at);
}

/// Its input is lost, or folded, while its output is up.
void Node::watch_for_break(Time now) {
  if (!in_.was_up || (in_.up && !in_.folded) || !out_.up || break_at_ != kNever) return;
  if (in_.up && break_is_own_) return;
  break_at_ = now + settings_.break_grace;
}

void Node::own_break_ends() {
  break_at_ = kNever;
  if (break_is_own_) break_.reset();
  break_is_own_ = false;
}

void Node::heard_break(int source, const wire::Beacon& beacon, Time at) {
  if (break_is_own_) return;
  if (beacon.break_known && beacon.break_behind == source) {
    break_known({beacon.break_before, beacon.break_behind}, false, beacon.input == wire::LinkState::folded, at);
  } else if (!beacon.break_known && break_ && break_->behind == source && state_ != NodeState::open_chain) {
    break_.reset();
  }
}

void Node::break_known(Break known, bool own, bool folded, Time now) {
  const bool joins = state_ == NodeState::starting || state_ == NodeState::joining;
  if (!folded) drained_at_ = kNever;
  const bool same = break_ && break_->before == known.before && break_->behind == known.behind && break_is_own_ == own;
  break_ = known;
  break_is_own_ = own;
  if (folded ? own : !same && state_ != NodeState::open_chain) want_beacon();
  if (folded) return beacons(now);
  if (joins) {
    if (!out_.up) return;
    if (!hello_out_) allowed_since_ = now;  // protocol.md section 6.4
    const bool out = hello_out_ && hello_due_ == kNever;
    set_state(NodeState::open_chain, now);
    end_unconfirmed(now);
    if (!out) say_hello(false, now);
  } else if (closed()) {
    if (!hello_out_) allowed_since_ = now;
    want_beacon();
    set_state(NodeState::open_chain, now);
    end_unconfirmed(now);
    if (hello_due_ != kNever) say_hello(true, now);
  }
  beacons(now);
}

// ---- beacons ----------------------------------------------------------------------------------------

wire::Beacon Node::beacon_now(Time now) const {
  wire::Beacon beacon;
  beacon.boot = boot_;
  beacon.cpu_boots = cpu_.boots;
  beacon.cpu_state = cpu_.state;
  const auto silent = (now - cpu_.spoke_at) / std::chrono::milliseconds(1);
  beacon.cpu_silent_ms = silent > 0xFFFFFFFF ? 0xFFFFFFFF : static_cast<std::uint32_t>(silent);
  const auto line_state = [](const NcLine& line) {
    return line.up && line.folded ? wire::LinkState::folded
           : line.up              ? wire::LinkState::up
           : line.was_up          ? wire::LinkState::silent
                                  : wire::LinkState::down;
  };
  beacon.input = line_state(in_);
  beacon.input_from = wire::NodeId{static_cast<std::uint8_t>(in_.neighbour)};
  beacon.output = line_state(out_);
  beacon.output_to = wire::NodeId{static_cast<std::uint8_t>(out_.neighbour)};
  beacon.break_known = break_.has_value();
  const Break known = break_.value_or(Break());
  beacon.break_before = wire::NodeId{static_cast<std::uint8_t>(known.before)};
  beacon.break_behind = wire::NodeId{static_cast<std::uint8_t>(known.behind)};
  beacon.cpu_comes_back = cpu_.comes_back;
  beacon.stop_latched = cpu_.stop_latched;
  beacon.latch = cpu_.latch;
  return beacon;
}

bool Node::may_say_beacon() const {
  if (settings_.beacon == Duration{0} || hello_out_ || beacon_out_) return false;
  return closed() || (state_ == NodeState::open_chain && hello_left_);
}

/// Than the first node's.
Duration Node::beacon_takes_longer() const {
  const int behind_first = static_cast<int>(distance(settings_.order.front(), id()));
  return settings_.beacon * behind_first / (4 * static_cast<int>(count_nodes()));
}

/// Says one if it is due.
void Node::beacons(Time now) {
  if (!may_say_beacon() || !(beacon_wanted_ || beacon_at_ <= now)) return;
  beacon_wanted_ = false;
  beacon_out_ = true;
  beacon_at_ = now + settings_.beacon + beacon_takes_longer();
  Send send;
  send.destination = kAll;
  send.last = 1 << 2;
  send.data.resize(wire::kLongBeaconSize);
  send.data.resize(wire::encode(beacon_now(now), send.data.data()));
  send.asked = send.due = now;
  data_.queues[0].push_back(send);
}

/// The next period begins, whether a beacon can be said now or not. (protocol.md sections 8.2 and 8.12)
void Node::beacon_period_over(Time now) {
  look_for_folds(now);
  if (may_say_beacon()) return;  // beacons() says it, and begins the period
  if (beacon_out_) want_beacon();
  beacon_at_ = now + settings_.beacon + beacon_takes_longer();
}

// ---- time ---------------------------------------------------------------------------------------------

void Node::membership_timers(Time now) {
  if (break_at_ <= now) {
    break_at_ = kNever;
    break_known({in_.neighbour, id()}, true, in_.up, now);
  }
  if (drained_at_ <= now) {
    drained_at_ = kNever;
    if (!in_.folded || !break_is_own_) {
      break_.reset();
      break_is_own_ = false;
    }
    set_state(closed_state(), now);
    allowed_since_ = now;
    new_hello_wanted_ = true;
  }
  if (hello_due_ <= now) hello_again(now);
  if (beacon_at_ <= now) beacon_period_over(now);
  new_hello_when_due(now);
  beacons(now);
}

Time Node::membership_deadline() const { return std::min({break_at_, drained_at_, hello_due_, beacon_at_}); }

}  // namespace limb_ring::model
