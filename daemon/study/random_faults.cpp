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

RandomFaults::RandomFaults(std::uint64_t seed, FoldBack fold_back, World world, const More& more)
    : draws_(seed),
      wide_(~seed),
      world_(fold_back, world, draws_, wide_),
      sought_(more.sought),
      sought_draws_(seed ^ kOfGoals),
      drifts_(drifts_of(seed, more.drift)),
      ring_(ring_options()),
      invariants_(ring_),
      lines_(ring_, seed),
      history_(ring_),
      killed_(ring_.size(), false) {
  ring_.on_event = [this](NodeId, const core::Event& event) {
    if (const auto* end = std::get_if<core::SendEnded>(&event.what)) ++ended_[static_cast<std::size_t>(end->outcome)];
  };
  tap_all(Line::first);
  if (world_.folds_back) tap_all(Line::second);
}

sim::VirtualRingOptions RandomFaults::ring_options() {
  sim::VirtualRingOptions options;
  options.order = world_.order;
  if (world_.takes_time_to_connect) options.connecting = [this] { return Duration{1ns} * wide_.below(20000); };
  if (world_.in_parts)
    options.noticing = [this] { return wide_.below(2) * Duration{1ns} * wide_.below(kNoticedWithin / 1ns); };
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
  if (goes_on()) calm_down();
  if (goes_on()) violation_ = sim::not_whole(ring_);
  if (goes_on()) check_silence();
  if (world_.is_wide && goes_on()) send_when_mended();
  return !stopped_;
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
  if (sought_ != nullptr && sought_draws_.once_in(kStepsToSeek)) seek();
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
  for (const sim::Strike strike : sought_->strikes) {
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
void RandomFaults::part_or_regroup(NodeId node) {
  core::RingOrder host;
  const std::size_t nodes = std::exchange(parted_, !parted_) ? 0 : 1 + wide_.below(world_.nodes - 1);
  for (std::size_t lines = 0; lines < nodes; ++lines) host.push_back(core::node_after(world_.order, node, lines));
  ring_.part(host);
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

unsigned RandomFaults::longest_hold(NodeId node, int share) const {
  return static_cast<unsigned>(ring_.settings(node).send_timeout() / share / 1ns);
}

// The node stands still for at most as long as a line may hold back, for the same reason: see line_fault().
void RandomFaults::stand_still(NodeId node) {
  const unsigned longest = longest_hold(node, world_.doubles ? 32 : 16);
  ring_.pause(node);
  ring_.at(ring_.now() + Duration{1ns} * (1 + wide_.below(longest)), [this, node] { ring_.resume(node); });
}

void RandomFaults::hold_output(NodeId node) {
  if (!ring_.alive(node)) return;
  const unsigned longest = longest_hold(node, world_.doubles ? 32 : 16);
  ring_.set_output_ready(node, false);
  ring_.at(ring_.now() + Duration{1ns} * (1 + wide_.below(longest)),
           [this, node] { ring_.set_output_ready(node, true); });
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
  if (!quiet_) history_.add(world_.folds_back ? Kind::mend_cable : Kind::mend_wire, node);
  world_.folds_back ? ring_.heal_cable(node) : ring_.heal(node);
}

void RandomFaults::kill_or_start(NodeId node) {
  history_.add(ring_.alive(node) ? fault::Name::kill : fault::Name::start, node);
  if (!ring_.alive(node)) return ring_.start(node);
  killed_[node] = true;
  ring_.kill(node);
}

void RandomFaults::freeze_or_thaw(NodeId node) {
  const fault::Name back = killed_[node] ? fault::Name::start : fault::Name::thaw;
  if (!quiet_) history_.add(ring_.alive(node) ? fault::Name::freeze : back, node);
  if (ring_.alive(node)) {
    killed_[node] = false;
    return ring_.freeze(node);
  }
  return killed_[node] ? ring_.start(node) : ring_.thaw(node);
}

// ---- afterwards -----------------------------------------------------------------------------

void RandomFaults::mend_all() {
  lines_.mend_all();
  ring_.regroup();
  parted_ = false;
  for (const NodeId node : world_.order) {
    ring_.set_cpu_reads(node, true);
    heal(node);
    if (!ring_.alive(node)) freeze_or_thaw(node);
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

}  // namespace limb_ring::study
