#include "core/membership/membership.h"

namespace limb_ring::core {
namespace {

constexpr std::uint32_t kHelloToken = 1;
constexpr std::uint32_t kBeaconToken = 2;
/// This many hellos and beacons with the own id that this node has not sent mean a duplicate id. Leftovers from before
/// a restart pass only once; another living node with this id goes on sending.
constexpr unsigned kDuplicateSigns = 3;

constexpr unsigned kStarting = in(NodeState::starting), kJoining = in(NodeState::joining),
                   kClosed = in(NodeState::up) | in(NodeState::alone) | in(NodeState::folded),
                   kOpenChain = in(NodeState::open_chain), kDuplicate = in(NodeState::duplicate_id);
constexpr unsigned kAny = kStarting | kJoining | kClosed | kOpenChain | kDuplicate;

Duration beacon_period(const Settings& settings) {
  const auto place = static_cast<int>(place_of(settings.order, settings.id));
  return settings.beacon + settings.beacon * place / (4 * static_cast<int>(settings.nodes()));
}

/// Puts what a CpuReport has into its place in a beacon that goes `now`.
template <class T>
void tell(const T& reported, T& told, Time) {
  told = reported;
}
void tell(Time spoke_at, std::uint32_t& silent_ms, Time now) {
  const auto silent = std::chrono::duration_cast<std::chrono::milliseconds>(now - spoke_at).count();
  silent_ms = static_cast<std::uint32_t>(std::clamp<std::int64_t>(silent, 0, UINT32_MAX));
}

}  // namespace

// clang-format off
// The table of protocol.md section 8.1.
const Membership::Row Membership::kTable[] = {
    // input                     from                   to                first                            then
    {Input::own_packet_home,    kDuplicate,            Next::joining,    nullptr,                         nullptr},
    {Input::own_control_home,   kOpenChain,            Next::same,       nullptr,                         &Membership::start_drain},
    {Input::both_lines_up,      kStarting,             Next::joining,    nullptr,                         &Membership::say_hello},
    {Input::both_lines_up,      kJoining | kDuplicate, Next::same,       nullptr,                         &Membership::say_hello},
    {Input::hello_home,         kOpenChain,            Next::same,       &Membership::join,               &Membership::beacon_changed},
    {Input::hello_home,         kAny & ~kOpenChain,    Next::closed,     &Membership::join,               &Membership::beacon_changed},
    {Input::hello_lost,         kAny & ~kOpenChain,    Next::same,       nullptr,                         &Membership::say_hello},
    {Input::hello_lost_no_line, kJoining,              Next::starting,   nullptr,                         nullptr},
    {Input::both_lines_lost,    kAny,                  Next::starting,   &Membership::start_over,         nullptr},
    {Input::numbers_due,        kClosed,               Next::same,       nullptr,                         &Membership::renumber},
    {Input::break_known,        kClosed,               Next::open_chain, nullptr,                         &Membership::go_on_unconfirmed},
    {Input::break_known,        kStarting | kJoining,  Next::open_chain, nullptr,                         &Membership::say_hello_into_chain},
    {Input::break_known,        kOpenChain,            Next::same,       nullptr,                         &Membership::stop_drain},
    {Input::drained,            kOpenChain,            Next::closed,     &Membership::confirm_again,      nullptr},
    {Input::duplicate_id,       kAny & ~(kStarting | kDuplicate), Next::duplicate_id, &Membership::begin_incarnation, &Membership::say_hello_if_lines_up},
};
// clang-format on

Membership::Membership(const Settings& settings, Transmit& transmit, DuplicateMemory& memory, Counters& counters,
                       EventQueue& events)
    : settings_(settings),
      transmit_(transmit),
      memory_(memory),
      counters_(counters),
      events_(events),
      beacon_period_(beacon_period(settings)),
      boot_(settings.boot),
      break_(settings.id) {
  transmit_.restart_numbers(boot_);
}

void Membership::on(Input input, Time now) {
  const Row* row = find_row(kTable, input, state_);
  if (row == nullptr) return;
  if (row->first) (this->*row->first)(now);
  switch (row->to) {
    case Next::same:
      break;
    case Next::starting:
      enter(NodeState::starting, now);
      break;
    case Next::joining:
      enter(NodeState::joining, now);
      break;
    case Next::closed:
      enter(closed_state(), now);
      break;
    case Next::open_chain:
      enter(NodeState::open_chain, now);
      break;
    case Next::duplicate_id:
      enter(NodeState::duplicate_id, now);
      break;
  }
  if (row->then) (this->*row->then)(now);
}

void Membership::enter(NodeState state, Time now) {
  if (state == state_) return;
  events_.put(now, StateChanged{state_, state});
  state_ = state;
}

NodeState Membership::closed_state() const {
  if (ring_size_ == 1) return NodeState::alone;
  return fold_.known ? NodeState::folded : NodeState::up;
}

// ---- the node's lines ---------------------------------------------------------------------

// Line and fold are set before a beacon can go: other nodes would take a broken line without a fold for an open chain.
void Membership::input_up(NodeId from, bool folded, Time now) {
  if (input_.up()) input_lost(now);
  input_.state = wire::LinkState::up;
  input_.neighbour = from;
  timers_.stop(Timer::own_break);
  break_.own_mended();
  set_folded(folded, output_.folded, now);
  lines_changed(now);
}

void Membership::input_lost(Time now) {
  if (!input_.up()) return;
  input_.lose();
  memory_.input_lost();
  if (input_.folded) break_.own_mended();  // likewise: it is found anew if the input stays lost
  lines_changed(now);
}

void Membership::output_up(NodeId to, bool folded, Time now) {
  if (output_.up()) output_lost(now);
  output_.state = wire::LinkState::up;
  output_.neighbour = to;
  set_folded(input_.folded, folded, now);
  lines_changed(now);
}

void Membership::output_lost(Time now) {
  if (!output_.up()) return;
  output_.lose();
  lines_changed(now);
}

void Membership::lines_changed(Time now) {
  if (input_.was_lost && output_.was_lost) on(Input::both_lines_lost, now);
  watch_for_break(now);
  if (accepts_sends())
    beacon_changed(now);
  else if (lines_up())
    on(Input::both_lines_up, now);
}

// ---- starting over --------------------------------------------------------------------------

// What it knows of the others, and they of it, is out of date. (ours, protocol.md section 4.8)
void Membership::start_over(Time now) {
  input_.was_lost = output_.was_lost = false;
  begin_incarnation(now);
  memory_.forget_verdicts(now);
  peers_.forget_all();
  ring_size_ = 0;
}

// Sends end cancelled, and everything is as after a start, until the next hello is home.
void Membership::begin_incarnation(Time now) {
  transmit_.set_open_chain(false, now);
  transmit_.restart(now);
  transmit_.set_gate(Gate::closed, now);
  joined_ = hello_.out = hello_.renumbering = merged_ = false;
  known_to_all_from_ = kNever;
  beacon_.out = false;
  timers_.stop_all();
  break_.forget();
  next_boot();
}

// A new incarnation: packets show it from now on, and sequence numbers start again at 0.
void Membership::next_boot() {
  ++boot_;
  transmit_.restart_numbers(boot_);
  memory_.meet_hello(settings_.id, boot_);  // packets to oneself
}

// ---- hello --------------------------------------------------------------------------------

void Membership::say_hello(Time now) {
  if (hello_.out) transmit_.restart(now);
  hello_.out = true;
  hello_.said = now;
  timers_.stop(Timer::hello);
  ++counters_.hellos;
  transmit_.set_gate(Gate::control, now);
  std::array<std::uint8_t, wire::kHelloSize> bytes;
  wire::encode(wire::Hello{boot_, hello_.renumbering}, bytes.data());
  transmit_.data.enqueue_control({bytes.data(), bytes.size()}, kHelloToken, now);
}

void Membership::say_hello_if_lines_up(Time now) {
  if (lines_up()) say_hello(now);
}

void Membership::hello_ended(const SendEnded& ended, Time now) {
  hello_.out = false;
  // A repeated one that nobody has taken ends lost, but it has come home. (ours, protocol.md section 4.8)
  const bool home = ended.outcome == Outcome::delivered || ended.outcome == Outcome::no_such_node ||
                    ended.outcome == Outcome::refused || ended.round_trip != Duration{0};
  if (home || state_ == NodeState::open_chain) return on(Input::hello_home, now);
  timers_.start(Timer::hello, hello_.said + settings_.send_timeout());
  if (timers_.due(Timer::hello, now)) hello_lost(now);
}

// If a line damages every packet, a hello is lost within a lap. Said again at once, those of all nodes would take
// the whole ring, and INTPs would wait among them. (ours, protocol.md section 8.1)
void Membership::hello_lost(Time now) {
  timers_.stop(Timer::hello);
  on(lines_up() ? Input::hello_lost : Input::hello_lost_no_line, now);
}

void Membership::join(Time now) {
  hello_.renumbering = false;
  joined_ = true;
  transmit_.set_gate(Gate::open, now);
}

// Begins new sequence numbers: once nothing is outstanding, a hello tells everyone to forget the old ones. (ours,
// protocol.md section 4.7)
void Membership::renumber(Time now) {
  if (!hello_.renumbering) transmit_.set_gate(Gate::closed, now);
  hello_.renumbering = true;
  if (!transmit_.idle()) return;
  transmit_.data.drop_control();  // nothing goes before the hello; its beacon follows it
  beacon_.out = hello_.out = merged_ = false;
  next_boot();
  say_hello(now);
}

void Membership::control_ended(Time now) {
  SendEnded ended;
  while (transmit_.data.take_control_end(ended)) {
    if (ended.token == kHelloToken) {
      hello_ended(ended, now);
    } else {
      beacon_.out = false;
      if (ended.outcome == Outcome::delivered) events_.put(now, BeaconHome{ended.round_trip});
      if (beacon_.wanted) send_beacon(now);
    }
  }
}

// ---- what comes home ----------------------------------------------------------------------

// An own packet is home, so this node was not bypassed. A line that is down stays lost. (ours, protocol.md section 4.8)
void Membership::forget_lost_lines() {
  input_.was_lost = !input_.up();
  output_.was_lost = !output_.up();
}

void Membership::came_home(std::uint8_t hop, Time now) {
  forget_lost_lines();
  duplicate_signs_ = 0;
  if (!hello_under_way() && has_merged(hop, now)) merged_ = true;
  ring_size_ = hop + 1u;
  if (closed()) return update_closed_state(now);
  on(Input::own_packet_home, now);
}

void Membership::own_seen(const wire::PacketFields& packet, bool matched, Time now) {
  if (!matched && ring_size_ != 0 && packet.hop() + 1u != ring_size_) duplicate_id_sign(packet.hop());
  if (!wire::is_control(packet)) return;
  if (const auto hello = wire::decode_hello(packet.data())) own_control_seen(hello->boot, packet.hop(), now);
  if (const auto beacon = wire::decode_beacon(packet.data())) own_control_seen(beacon->boot, packet.hop(), now);
}

void Membership::duplicate_id_sign(std::uint8_t hop) {
  ++counters_.duplicate_id_signs;
  counters_.last_duplicate = {settings_.id, hop};
}

void Membership::own_control_seen(std::uint64_t boot, std::uint8_t hop, Time now) {
  if (boot == boot_) {
    // Until the last try has left, and no copy of it is under way.
    const Duration tries =
        settings_.falls_into_parts() ? settings_.tries_last() + settings_.send_timeout() : Duration{0};
    known_to_all_from_ = std::min(known_to_all_from_, now + tries);
    if (state_ == NodeState::open_chain) {
      forget_lost_lines();
      ring_size_ = hop + 1u;
    }
    return on(Input::own_control_home, now);
  }
  if (boot >= settings_.boot && boot < boot_) return;  // of this process, before its last new hello
  duplicate_id_sign(hop);
  // The two nodes take each other's packets off the ring, so nothing is confirmed. This one goes on saying hello; when
  // one comes home, the other node is gone. (ours, protocol.md section 8.6)
  if (++duplicate_signs_ >= kDuplicateSigns) on(Input::duplicate_id, now);
}

// ---- the others ---------------------------------------------------------------------------

bool Membership::heard(const wire::PacketFields& packet, Time now) {
  if (const auto hello = wire::decode_hello(packet.data())) return heard_hello(packet, *hello, now);
  if (const auto beacon = wire::decode_beacon(packet.data())) return heard_beacon(packet, *beacon, now);
  ++counters_.control_malformed;
  counters_.last_control = {packet.source(), packet.hop()};
  return true;
}

bool Membership::heard_hello(const wire::PacketFields& packet, const wire::Hello& hello, Time now) {
  const NodeId source = packet.source();
  const Peer& peer = peers_[source];
  const bool goes_on = hello.remembers && peer.known && hello.boot == peer.boot + 1;  // no start was missed
  if (!memory_.meet_hello(source, hello.boot)) {
    ++counters_.earlier_incarnation;
    return false;
  }
  // The source has forgotten which packets of this node it took.
  if (peers_.heard_hello(source, packet.hop(), hello, now) && !goes_on) transmit_.forgotten_by(source, now);
  return true;
}

// In an open chain a hello can be missed; the boot number in later beacons still tells of the restart. The first beacon
// that is heard of a node does not. (ours, protocol.md section 4.10)
bool Membership::heard_beacon(const wire::PacketFields& packet, const wire::Beacon& beacon, Time now) {
  const NodeId source = packet.source();
  if (!memory_.meet_beacon(source, beacon.boot, now)) {
    ++counters_.earlier_incarnation;
    return false;
  }
  if (peers_[source].known && peers_[source].boot != beacon.boot) transmit_.forgotten_by(source, now);
  if (peers_.heard_beacon(source, packet.hop(), beacon, now)) events_.put(now, PeerChanged{source});
  if (break_.heard(beacon, source) && beacon.input != wire::LinkState::folded) break_known(now);
  if (!beacon.break_known && state_ != NodeState::open_chain) break_.withdrawn_by(source);
  look_for_folds(now);
  send_beacon_along(now);
  return true;
}

// ---- own beacons ----------------------------------------------------------------------------

void Membership::set_cpu(const CpuReport& report, Time now) {
  const bool news = report.is_news_after(cpu_);
  cpu_ = report;
  if (news && accepts_sends()) beacon_changed(now);
}

wire::Beacon Membership::beacon(Time now) const {
  wire::Beacon b;
  b.boot = boot_;
  CpuReport::fields([&](const char*, auto member, auto told_as, bool) { tell(cpu_.*member, b.*told_as, now); });
  b.input = input_.shown();
  b.input_from = input_.neighbour;
  b.output = output_.shown();
  b.output_to = output_.neighbour;
  b.break_known = break_.known();
  if (const auto line = break_.line()) {
    b.break_before = line->before;
    b.break_behind = line->behind;
  }
  return b;
}

// Something that beacons say has changed: say it at once.
void Membership::beacon_changed(Time now) {
  if (settings_.beacon.count() == 0) return;
  if (beacon_.out)
    beacon_.wanted = true;
  else
    send_beacon(now);
}

// Sends the own beacon with that of another node if the last one was some time ago: then all beacons of a quiet ring go
// round together. (ours, protocol.md section 8.2)
void Membership::send_beacon_along(Time now) {
  if (!beacon_.out && timers_[Timer::beacon] - beacon_period_ <= now - settings_.beacon / 2) send_beacon(now);
}

void Membership::send_beacon(Time now) {
  if (hello_under_way() || !accepts_sends()) return;
  beacon_.wanted = false;
  timers_.start(Timer::beacon, now + beacon_period_);
  beacon_.out = true;
  std::array<std::uint8_t, wire::kLongBeaconSize> bytes;
  const std::size_t size = wire::encode(beacon(now), bytes.data());
  transmit_.data.enqueue_control({bytes.data(), size}, kBeaconToken, now);
}

// ---- time ---------------------------------------------------------------------------------

void Membership::act_on_time(Time now) {
  if (timers_.due(Timer::own_break, now)) own_input_broken(now);
  if (timers_.due(Timer::drained, now)) on(Input::drained, now);
  if (timers_.due(Timer::hello, now)) hello_lost(now);
  if (timers_.due(Timer::beacon, now)) {
    timers_.start(Timer::beacon, now + beacon_period_);
    look_for_folds(now);  // first: the beacon says what is known after it
    beacon_changed(now);
  }
}

}  // namespace limb_ring::core
