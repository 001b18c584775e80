#include "study/random_faults.h"

#include <algorithm>
#include <utility>

#include "sim/virtual_line_faults.h"

namespace limb_ring::study {

using core::Duration;
using core::Line;
using scenario::SoakAction;
using wire::NodeId;
using Kind = SoakAction::Kind;
using namespace std::chrono_literals;

namespace {

constexpr unsigned kSteps = 1200;
constexpr unsigned kStepsToStorm = 16;
/// Before a storm: longer than ends take to notice, a node to join, and a beacon to come.
constexpr Duration kMostBeforeStorm = 2ms;
constexpr unsigned kStepsToSeek = 24;
/// So that what is sought is drawn by other numbers than all else.
constexpr std::uint64_t kOfGoals = 0x60a15, kOfClocks = 0xc10c5;

/// By id. @param most 0: none
std::vector<int> drifts_of(std::uint64_t seed, unsigned most) {
  std::vector<int> drifts;
  Draws draws(seed ^ kOfClocks);
  for (unsigned id = 0; most != 0 && id < wire::kBroadcast; ++id)
    drifts.push_back(static_cast<int>(draws.below(2 * most + 1)) - static_cast<int>(most));
  return drifts;
}

}  // namespace

RandomFaults::RandomFaults(const Origin& origin)
    : origin_(origin),
      draws_(origin.seed),
      wide_(~origin.seed),
      world_(origin.fold_back, origin.world, draws_, wide_),
      sought_draws_(origin.seed ^ kOfGoals),
      drifts_(drifts_of(origin.seed, origin.more.drift)),
      clock_draws_(origin.seed ^ ~kOfClocks),
      ring_(ring_options()),
      invariants_(ring_),
      lines_(ring_, origin.seed),
      history_(ring_),
      killed_(ring_.size(), false) {
  ring_.on_event = [this](NodeId, const core::Event& event) {
    if (const auto* end = std::get_if<core::SendEnded>(&event.what)) ++ended_[static_cast<std::size_t>(end->outcome)];
  };
  tap_all(Line::first);
  if (world_.folds_back) tap_all(Line::second);
  made_ = true;
}

sim::VirtualRingOptions RandomFaults::ring_options() {
  sim::VirtualRingOptions options;
  options.order = world_.order;
  if (world_.takes_time_to_connect)
    options.connecting = [this] { return wait([this] { return Duration{1ns} * wide_.below(20000); }); };
  if (world_.in_parts)
    options.noticing = [this] {
      return wait([this] { return wide_.below(2) * Duration{1ns} * wide_.below(kNoticedWithin / 1ns); });
    };
  options.byte_time = world_.paced ? Duration{8ns} : Duration{0};
  options.keep_logs = false;
  options.adjust = [this](core::Settings& settings) { world_.adjust(settings); };
  if (!drifts_.empty()) options.drift = [this](NodeId id) { return drifts_[id]; };
  return options;
}

void RandomFaults::tap_all(Line line) {
  for (const NodeId id : world_.order) {
    const auto tap = [this, id, line](const wire::Slice& slice, core::Time, wire::SliceWriter& arriving) {
      pass(id, line, slice, arriving);
    };
    ring_.tap(id, tap, line);
  }
}

// ---- lines ----------------------------------------------------------------------------------

void RandomFaults::pass(NodeId id, Line line, const wire::Slice& slice, wire::SliceWriter& arriving) {
  history_.count_slice(id, line);
  if (quiet_ && sim::is_traffic(slice)) ++slices_when_quiet_;
  if (again_) return pass_again(id, line, slice, arriving);
  const bool word_lost = !quiet_ && slice.kind == wire::SliceKind::fold && wide_.once_in(world_.lost_words);
  if (word_lost || (!quiet_ && draws_.once_in(world_.drop))) return history_.add_slice(Kind::lose_slice, id, line);
  if (quiet_ || slice.bytes.empty() || !draws_.once_in(world_.damage)) return lines_.pass(id, line, slice, arriving);
  const auto bits = static_cast<std::uint8_t>(1 + draws_.below(255));
  const std::size_t at = draws_.below(static_cast<unsigned>(slice.bytes.size));
  history_.add_slice(Kind::damage_slice, id, line, at, bits);
  lines_.pass_damaged(id, line, slice, at, bits, arriving);
}

// ---- what happens ---------------------------------------------------------------------------

bool RandomFaults::run(std::function<bool()> asked_to_stop) {
  asked_to_stop_ = std::move(asked_to_stop);
  ring_.join([this] { return must_stop(); });
  const unsigned steps = world_.nodes <= 16 ? kSteps : kSteps * 16 / world_.nodes;
  for (unsigned step = 0; step < steps && goes_on(); ++step) {
    act();
    ring_.run_for(random_while());
    note_violation();
  }
  acted_until_ = ring_.now();
  if (ends_whole() && world_.is_wide) send_when_mended();
  return !stopped_;
}

/// @return whether it goes on
bool RandomFaults::ends_whole() {
  if (goes_on()) calm_down();
  if (goes_on()) violation_ = sim::not_whole(ring_);
  if (goes_on()) check_silence();
  return goes_on();
}

void RandomFaults::note_violation() { violation_ = invariants_.violation(); }

std::uint64_t RandomFaults::hops() const {
  std::uint64_t hops = 0;
  for (const NodeId id : world_.order) {
    const core::Counters& c = ring_.counters(id);
    hops += c.relayed_data + c.relayed_interrupts + c.sent_data + c.sent_interrupts;
  }
  return hops;
}

void RandomFaults::act() {
  if (draws_.once_in(world_.trouble)) fault();
  if (world_.is_wide && wide_.once_in(world_.trouble)) {
    const NodeId node = world_.order[wide_.below(world_.nodes)];
    const bool stands_still = !world_.paced && wide_.below(2) == 0;
    stands_still ? stand_still(node) : hold_output(node);
  }
  if (world_.in_parts && wide_.once_in(world_.trouble)) burst();
  if (world_.storms && wide_.once_in(kStepsToStorm)) storm();
  if (origin_.more.sought != nullptr && sought_draws_.once_in(kStepsToSeek)) seek();
  if (origin_.more.clocks && clock_draws_.once_in(world_.trouble)) clock_fault();
  if (draws_.once_in(7))
    interrupt();
  else
    send();
}

void RandomFaults::send() {
  const NodeId source = random_node();
  if (!can_ask(source)) return;
  std::vector<std::uint8_t> data(draws_.once_in(3) ? wire::kMaxPayload : 1 + draws_.below(wire::kMaxPayload));
  for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(draws_.below(256));
  const auto priority = static_cast<std::uint8_t>(draws_.below(4));
  const NodeId destination = random_destination();
  scenario::Send send;
  send.from = {source};
  send.to = destination;
  send.size = static_cast<unsigned>(data.size());
  send.priority = priority;
  history_.add(send);
  ring_.send(source, destination, data, priority);
}

void RandomFaults::interrupt() {
  const NodeId source = random_node();
  if (!can_ask(source)) return;
  const auto factor = static_cast<std::uint8_t>(draws_.below(8));
  const NodeId destination = random_destination();
  scenario::Send send;
  send.from = {source};
  send.to = destination;
  send.interrupt = factor;
  history_.add(send);
  ring_.interrupt(source, destination, factor);
}

void RandomFaults::fault() {
  const NodeId node = random_node();
  switch (draws_.below(13)) {
    case 0:
      return kill_or_start(node);
    case 1:
      return power_cycle(node);
    case 2:
      return freeze_or_thaw(node);
    case 3:
      return ring_.alive(node) ? cut(node) : kill_or_start(node);
    case 4:
    case 5:
      return heal(node);
    case 6:
      return hang_or_go_on(node);
    case 7:
      return cancel(node);
    case 8:
      return reset_cpu(node);
    case 9:
      return ring_.alive(node) ? freeze_or_thaw(node) : kill_or_start(node);
    case 10:
    case 11:
    case 12:
      return line_fault(node);
  }
}

void RandomFaults::hang_or_go_on(NodeId node) {
  history_.add(ring_.cpu_reads(node) ? fault::Name::not_reading : fault::Name::resume, node);
  ring_.set_cpu_reads(node, !ring_.cpu_reads(node));
}

void RandomFaults::cancel(NodeId node) {
  history_.add(Kind::cancel, node);
  if (ring_.alive(node)) ring_.cancel(node);
}

void RandomFaults::reset_cpu(NodeId node) {
  history_.add(fault::Name::reset, node);
  if (ring_.alive(node)) ring_.reset_cpu(node);
}

void RandomFaults::power_cycle(NodeId node) {
  history_.add(fault::Name::power_cycle, node);
  if (ring_.alive(node)) ring_.kill(node);
  killed_[node] = true;
  ring_.start(node);
}

// Near each other and within a lap: what the first strike has turned back, or cut off, is still under way.
void RandomFaults::burst() {
  std::size_t place = wide_.below(world_.nodes);
  for (unsigned strikes = 2 + wide_.below(3); strikes > 0 && goes_on(); --strikes) {
    const NodeId node = world_.order[place % world_.nodes];
    strike(node);
    draws_.once_in(2) ? interrupt() : send();
    place += world_.nodes - 1 + wide_.below(3);
    ring_.run_for(Duration{1ns} * wide_.below(static_cast<unsigned>(ring_.settings(node).worst_lap() / 1ns)));
    note_violation();
  }
}

void RandomFaults::storm() {
  mend_all();
  ring_.run_for(Duration{1ns} * wide_.below(kMostBeforeStorm / 1ns));
  note_violation();
  if (goes_on()) burst();
}

void RandomFaults::strike(NodeId node) {
  switch (wide_.below(world_.storms ? 11 : 9)) {
    case 0:
      return part_or_regroup(node);
    case 1:
    case 9:
    case 10:
      return power_cycle(node);
    case 2:
      return freeze_or_thaw(node);
    case 3:
    case 4:
      return heal(node);
    default:
      return ring_.alive(node) ? cut(node) : kill_or_start(node);
  }
}

// The strikes of the goal, most of them within a lap, where a ring may be whole, or not. Some goals need longer than
// that between two of them: a beacon, or a try.
void RandomFaults::seek() {
  if (sought_draws_.once_in(2)) seek_by(sim::Strike::mend_all, random_node());
  std::size_t place = sought_draws_.below(world_.nodes);
  for (const sim::Strike strike : origin_.more.sought->strikes) {
    if (strike == sim::Strike::none || !goes_on()) return;
    const NodeId node = world_.order[place % world_.nodes];
    seek_by(strike, node);
    place += world_.nodes - 1 + sought_draws_.below(3);
    const Duration lap = ring_.settings(node).worst_lap();
    const Duration longest = sought_draws_.once_in(3) ? std::max<Duration>(4 * lap, kMostBeforeStorm) : lap;
    ring_.run_for(Duration{1ns} * sought_draws_.below(static_cast<unsigned>(longest / 1ns) + 1));
    note_violation();
  }
}

void RandomFaults::seek_by(sim::Strike strike, NodeId node) {
  using sim::Strike;
  switch (strike) {
    case Strike::none:
      return;
    case Strike::restart:
      return power_cycle(node);
    case Strike::kill:
      return ring_.alive(node) ? kill_or_start(node) : void();
    case Strike::freeze:
      return freeze_or_thaw(node);
    case Strike::cut:
      return cut(node);
    case Strike::mend:
      return heal(node);
    case Strike::host:
      return part_or_regroup(node);
    case Strike::lose:
      return lose_next(node);
    case Strike::hold:
      return hold_output(node);
    case Strike::hang:
      return hang_or_go_on(node);
    case Strike::reset:
      return reset_cpu(node);
    case Strike::cancel:
      return cancel(node);
    case Strike::send:
      return send();
    case Strike::interrupt:
      return interrupt();
    case Strike::mend_all:
      mend_all();
      ring_.run_for(Duration{1ns} * sought_draws_.below(kMostBeforeStorm / 1ns));
      return note_violation();
  }
}

void RandomFaults::lose_next(NodeId node) {
  fault::Fault fault;
  fault.name = fault::Name::drop;
  fault.nodes = {node};
  fault.packets = 1 + sought_draws_.below(3);
  history_.add(fault);
  lines_.begin(fault);
}

// A host has nodes beside each other, from this one on.
void RandomFaults::part_or_regroup(NodeId node) { parted_ ? regroup() : part(node, 1 + wide_.below(world_.nodes - 1)); }

void RandomFaults::part(NodeId from, std::size_t nodes) {
  history_.add(WorldAction{WorldAction::Kind::part, from, nodes, {}});
  parted_ = true;
  core::RingOrder host;
  for (std::size_t lines = 0; lines < nodes; ++lines) host.push_back(core::node_after(world_.order, from, lines));
  ring_.part(host);
}

void RandomFaults::regroup() {
  history_.add(WorldAction{WorldAction::Kind::regroup, {}, 0, {}});
  parted_ = false;
  ring_.regroup();
}

// No copy may outlive the time-out of a try: the receiver would take it for a new packet, as would one that has
// restarted meanwhile and knows nothing of the first copy. So a line holds back for a part of the time-out only. The
// part is small where lines duplicate, and where folded lines send packets without an owner round and round.
void RandomFaults::line_fault(NodeId node) {
  const unsigned longest = longest_hold(node, world_.doubles ? 32 : world_.folds_back ? 16 : 2);
  fault::Fault fault;
  fault.name = draws_.once_in(2) ? fault::Name::delay : world_.doubles ? fault::Name::duplicate : fault::Name::stall;
  fault.nodes = {node};
  fault.second_line = world_.folds_back && draws_.once_in(3);
  fault.once_in = 1 + draws_.below(10);
  fault.delay = 1ns * (1 + draws_.below(longest));
  fault.jitter = 1ns * draws_.below(longest);
  fault.lasts = fault.name == fault::Name::stall ? 1ns * (1 + draws_.below(longest)) : 1us * (1 + draws_.below(1000));
  history_.add(fault);
  lines_.begin(fault);
}

// A wall clock is set by up to an hour; one life moves it by 4.3 s. No monotonic clock skips a time here: all that
// judges a ring measures spans by the ring's clock.
void RandomFaults::clock_fault() {
  const NodeId node = world_.order[clock_draws_.below(world_.nodes)];
  fault::Fault fault;
  fault.name = fault::Name::step_clock;
  fault.nodes = {node};
  switch (clock_draws_.below(4)) {
    case 0:
      fault.forward = 1s * (1 + clock_draws_.below(3600));
      break;
    case 1:
      fault.back = 1s * (1 + clock_draws_.below(3600));
      break;
    default:
      return suspend_or_wake(node);
  }
  history_.add(fault);
  sim::step_clocks(ring_, fault);
}

// A host has up to half of the nodes, beside each other, from this one on.
void RandomFaults::suspend_or_wake(NodeId node) {
  if (!suspended_.empty()) {
    for (const NodeId id : std::exchange(suspended_, {}))
      if (!ring_.alive(id) && !killed_[id]) freeze_or_thaw(id);
    return;
  }
  const std::size_t nodes = 1 + clock_draws_.below(std::max(world_.nodes / 2, 1u));
  for (std::size_t lines = 0; lines < nodes; ++lines) {
    const NodeId id = core::node_after(world_.order, node, lines);
    if (!ring_.alive(id)) continue;
    suspend(id);
    suspended_.push_back(id);
  }
}

void RandomFaults::suspend(NodeId node) {
  history_.add(fault::Name::suspend, node);
  killed_[node] = false;
  ring_.freeze(node, true);
}

unsigned RandomFaults::longest_hold(NodeId node, int share) const {
  return static_cast<unsigned>(ring_.settings(node).send_timeout() / share / 1ns);
}

// At most as long as a line may hold back, for the same reason: see line_fault().
Duration RandomFaults::hold(NodeId node) {
  return Duration{1ns} * (1 + wide_.below(longest_hold(node, world_.doubles ? 32 : 16)));
}

void RandomFaults::stand_still(NodeId node) { stand_still(node, hold(node)); }

void RandomFaults::stand_still(NodeId node, Duration lasts) {
  history_.add(WorldAction{WorldAction::Kind::stand_still, node, 0, lasts});
  ring_.pause(node);
  ring_.at(ring_.now() + lasts, [this, node] { ring_.resume(node); });
}

void RandomFaults::hold_output(NodeId node) {
  if (!ring_.alive(node)) return;
  hold_output(node, hold(node));
}

void RandomFaults::hold_output(NodeId node, Duration lasts) {
  history_.add(WorldAction{WorldAction::Kind::hold_output, node, 0, lasts});
  ring_.set_output_ready(node, false);
  ring_.at(ring_.now() + lasts, [this, node] { ring_.set_output_ready(node, true); });
}

void RandomFaults::cut(NodeId node) {
  if (!world_.folds_back || draws_.once_in(3)) {
    history_.add(Kind::cut_wire, node);
    return ring_.cut(node);
  }
  const NodeId after = core::node_after(world_.order, node, 1);
  if (draws_.once_in(4)) {
    history_.add(Kind::cut_wire, after, true);
    return ring_.cut(after, Line::second);
  }
  history_.add(Kind::cut_cable, node);
  ring_.cut_cable(node);
}

void RandomFaults::heal(NodeId node) {
  history_.add(world_.folds_back ? Kind::mend_cable : Kind::mend_wire, node);
  heal_now(node);
}

void RandomFaults::kill_or_start(NodeId node) {
  history_.add(ring_.alive(node) ? fault::Name::kill : fault::Name::start, node);
  if (!ring_.alive(node)) return ring_.start(node);
  killed_[node] = true;
  ring_.kill(node);
}

void RandomFaults::freeze_or_thaw(NodeId node) {
  const fault::Name back = killed_[node] ? fault::Name::start : fault::Name::thaw;
  history_.add(ring_.alive(node) ? fault::Name::freeze : back, node);
  if (!ring_.alive(node)) return bring_back(node);
  killed_[node] = false;
  ring_.freeze(node);
}

// ---- afterwards -----------------------------------------------------------------------------

void RandomFaults::mend_all() {
  if (!quiet_) history_.add(WorldAction{});
  lines_.mend_all();
  ring_.regroup();
  parted_ = false;
  suspended_.clear();
  for (const NodeId node : world_.order) {
    ring_.set_cpu_reads(node, true);
    heal_now(node);
    if (!ring_.alive(node)) bring_back(node);
  }
}

void RandomFaults::calm_down() {
  quiet_ = true;
  mend_all();
  run_until_calm();
}

// Whatever is left over at its end breaks a promise.
void RandomFaults::run_until_calm() {
  sim::run_until_calm(ring_, invariants_, slices_when_quiet_, [this] { return must_stop(); });
  if (!stopped_) invariants_.finish();
  note_violation();
}

void RandomFaults::check_silence() {
  slices_when_quiet_ = 0;
  ring_.run_for(20ms);
  note_violation();
  if (!violation_) violation_ = sim::not_silent(ring_, slices_when_quiet_);
}

// With all mended, every bound is in force again for this traffic.
void RandomFaults::send_when_mended() {
  for (unsigned step = 0; step < kSteps / 8 && goes_on(); ++step) {
    draws_.once_in(7) ? interrupt() : send();
    ring_.run_for(random_while());
    note_violation();
  }
  if (goes_on()) run_until_calm();
}

// ---- once more, or otherwise ----------------------------------------------------------------

void RandomFaults::draw_anew(core::Time from, std::uint64_t seed) {
  ring_.at(from, [this, seed] {
    draws_ = Draws(seed);
    wide_ = Draws(~seed);
    sought_draws_ = Draws(seed ^ kOfGoals);
  });
}

void RandomFaults::replay(const RandomFaults& of, const std::vector<RecordedStep>& steps, core::Time until, bool ends) {
  asked_to_stop_ = [] { return false; };
  again_.emplace(Again{of, {}, {}, 0});
  for (const RecordedStep& step : steps)
    if (const SoakAction* hit = slice_hit(step)) again_->hits.push_back({step, hit->nth});
  do_again(steps, core::Time{}, until);
  if (goes_on()) ring_.run_until(until);
  note_violation();
  acted_until_ = ring_.now();
  if (!ends || !ends_whole() || !world_.is_wide) return;
  do_again(steps, until, core::kNever);
  if (goes_on()) run_until_calm();
}

// If the same instant comes again, so does what was drawn in it.
Duration RandomFaults::wait(const std::function<Duration()>& draw) {
  if (!made_) return draw();
  if (again_) {
    if (again_->instant != ring_.now()) again_->instant = ring_.now(), again_->waits = 0;
    const auto known = again_->of.history_.waits().find(ring_.now());
    if (known != again_->of.history_.waits().end() && again_->waits < known->second.size())
      return known->second[again_->waits++];
  }
  const Duration drawn = draw();
  history_.add_wait(drawn);
  return drawn;
}

void RandomFaults::pass_again(NodeId id, Line line, const wire::Slice& slice, wire::SliceWriter& arriving) {
  const auto hit = quiet_ ? std::nullopt : hit_again(id, line);
  if (!hit || (hit->kind == Kind::damage_slice && slice.bytes.empty())) return lines_.pass(id, line, slice, arriving);
  if (hit->kind == Kind::lose_slice) return;
  const std::size_t byte = std::min<std::size_t>(hit->byte, slice.bytes.size - 1);
  lines_.pass_damaged(id, line, slice, byte, hit->bits, arriving);
}

/// What hits the slice that leaves there now.
std::optional<SoakAction> RandomFaults::hit_again(NodeId id, Line line) {
  std::optional<SoakAction> now;
  for (Again::Hit& hit : again_->hits) {
    const SoakAction& what = *slice_hit(hit.step);
    const bool here = what.node == id && what.second_line == (line == Line::second);
    if (here && hit.left != 0 && hit.step.at <= ring_.now() && --hit.left == 0) now = what;
  }
  return now;
}

/// Those steps whose instant is behind `from`, or at the very start, and not behind `until`.
void RandomFaults::do_again(const std::vector<RecordedStep>& steps, core::Time from, core::Time until) {
  for (const RecordedStep& step : steps) {
    const bool due = (step.at > from || from == core::Time{}) && step.at <= until;
    if (!due || slice_hit(step) != nullptr) continue;
    if (step.at > ring_.now()) ring_.run_until(step.at);
    note_violation();
    if (!goes_on()) return;
    std::visit([this](const auto& what) { do_again(what); }, step.what);
  }
}

void RandomFaults::do_again(const scenario::Send& send) {
  const NodeId source = send.from[0];
  if (!can_ask(source)) return;
  if (send.interrupt) {
    ring_.interrupt(source, send.to, *send.interrupt);
    return;
  }
  std::vector<std::uint8_t> data(send.size);
  for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(draws_.below(256));
  ring_.send(source, send.to, data, send.priority);
}

void RandomFaults::do_again(const fault::Fault& fault) {
  using fault::Name;
  const NodeId node = fault.nodes[0];
  const bool alive = ring_.alive(node);
  switch (fault.name) {
    case Name::kill:
      return alive ? kill_or_start(node) : void();
    case Name::start:
      return alive ? void() : kill_or_start(node);
    case Name::freeze:
      return alive ? freeze_or_thaw(node) : void();
    case Name::thaw:
      return alive ? void() : freeze_or_thaw(node);
    case Name::suspend:
      return alive ? suspend(node) : void();
    case Name::step_clock:
      return sim::step_clocks(ring_, fault);
    case Name::power_cycle:
      return power_cycle(node);
    case Name::not_reading:
    case Name::resume:
      return ring_.set_cpu_reads(node, fault.name == Name::resume);
    case Name::reset:
      return reset_cpu(node);
    default:
      return lines_.begin(fault);
  }
}

void RandomFaults::do_again(const SoakAction& action) {
  const Line line = action.second_line ? Line::second : Line::first;
  switch (action.kind) {
    case Kind::cut_wire:
      return ring_.cut(action.node, line);
    case Kind::mend_wire:
      return ring_.heal(action.node, line);
    case Kind::cut_cable:
      return ring_.cut_cable(action.node);
    case Kind::mend_cable:
      return ring_.heal_cable(action.node);
    case Kind::cancel:
      return cancel(action.node);
    case Kind::lose_slice:
    case Kind::damage_slice:
      return;  // as they leave
  }
}

void RandomFaults::do_again(const WorldAction& action) {
  switch (action.kind) {
    case WorldAction::Kind::part:
      return part(action.node, action.nodes);
    case WorldAction::Kind::regroup:
      return regroup();
    case WorldAction::Kind::stand_still:
      return stand_still(action.node, action.lasts);
    case WorldAction::Kind::hold_output:
      return ring_.alive(action.node) ? hold_output(action.node, action.lasts) : void();
    case WorldAction::Kind::mend_all:
      return mend_all();
  }
}

}  // namespace limb_ring::study
