#include "study/soak/random_faults.h"

#include <algorithm>

#include "sim_tools/mended_ring.h"

namespace limb_ring::study {

using core::Duration;
using core::Line;
using scenario::SoakAction;
using wire::NodeId;
using Kind = SoakAction::Kind;
using namespace std::chrono_literals;

namespace {

constexpr unsigned kSteps = 1200;

}  // namespace

RandomFaults::RandomFaults(std::uint64_t seed, FoldBack fold_back, World world)
    : seed_(seed), random_(seed), is_wide_(world == World::wide), wide_(~seed) {
  choose_mix(fold_back);
  choose_world();
  make_ring();
}

void RandomFaults::choose_mix(FoldBack fold_back) {
  nodes_ = once_in(3) ? 2 + random(15) : 16;
  // Rings of two fold back, too, and `ring_sim explore` has them; here the histories of their seeds would change.
  if (fold_back == FoldBack::all && nodes_ < 3) nodes_ = 3;
  paced_ = once_in(2);
  const unsigned levels[] = {0, 2000, 200, 33};
  drop_ = levels[random(4)];
  damage_ = levels[random(4)];
  trouble_ = levels[random(4)];
  const bool drawn = nodes_ > 2 && once_in(3);
  fold_back_ = drawn || fold_back == FoldBack::all;
  doubles_ = once_in(2) && !fold_back_;  // a fold may bring the copy behind the source's next packet
}

void RandomFaults::choose_world() {
  if (is_wide_ && wide(60) == 0) grow();
  std::vector<NodeId> ids;
  for (unsigned id = 0; id < (is_wide_ ? 255 : nodes_); ++id) ids.push_back(static_cast<NodeId>(id));
  for (std::size_t i = ids.size(); is_wide_ && i-- > 1;) std::swap(ids[i], ids[wide(static_cast<unsigned>(i) + 1)]);
  order_.assign(ids.begin(), ids.begin() + nodes_);
  for (unsigned i = 0; is_wide_ && i < nodes_; ++i) {
    delays_.push_back(1ns * (200 + wide(2000)));
    slownesses_.push_back(wide(3) == 0 ? 1 + wide(4) : 1);
  }
}

// Its lines lose and damage as much in a lap as those of a ring of 16: if each of 200 lines lost one slice in 33, no
// packet would come round, and the nodes would never join.
void RandomFaults::grow() {
  nodes_ = 17 + wide(238);
  drop_ = drop_ * nodes_ / 16;
  damage_ = damage_ * nodes_ / 16;
}

// Its lines, and what follows from them for the whole ring.
void RandomFaults::differ(core::Settings& s) const {
  const std::size_t place = core::place_of(order_, s.id);
  if (!is_wide_ || place == nodes_) return;
  core::Duration all{0};
  for (const core::Duration delay : delays_) all += delay;
  const unsigned slowest = *std::max_element(slownesses_.begin(), slownesses_.end());
  s.lap = nodes_ * s.byte_time_out * slowest * static_cast<int>(wire::kMaxDataPacketSize + wire::kInterruptPacketSize) +
          all;
  s.all_delays = all;
  s.byte_time_in = s.byte_time_out * slownesses_[(place + nodes_ - 1) % nodes_];
  s.byte_time_out = s.byte_time_out * slownesses_[place];
  s.relay_delay = delays_[place];
  s.beacon *= 1 + nodes_ / 16;
}

std::string RandomFaults::describe() const {
  const auto rate = [](const char* what, unsigned times) {
    return times == 0 ? "" : std::string(", ") + what + " once in " + std::to_string(times);
  };
  return std::to_string(nodes_) + " nodes, lines " + (paced_ ? "of 1 Gbit/s" : "without a rate") +
         (fold_back_ ? ", folding back" : "") + (is_wide_ ? ", a wide world" : "") + rate("a slice lost", drop_) +
         rate("damaged", damage_) + rate("a fault in a step", trouble_);
}

void RandomFaults::make_ring() {
  sim::VirtualRingOptions options;
  options.order = order_;
  if (is_wide_ && wide(2) == 0) options.connecting = [this] { return Duration{1ns} * wide(20000); };
  options.byte_time = paced_ ? Duration{8ns} : Duration{0};
  options.keep_logs = false;
  options.adjust = [this](core::Settings& s) {
    sim::set_short_times(s, paced_, fold_back_);
    differ(s);
  };
  ring_ = std::make_unique<sim::VirtualRing>(options);
  killed_.assign(ring_->size(), false);
  invariants_ = std::make_unique<sim::Invariants>(*ring_);
  lines_ = std::make_unique<sim::VirtualLineFaults>(*ring_, seed_);
  ring_->on_event = [this](NodeId, const core::Event& event) {
    if (const auto* end = std::get_if<core::SendEnded>(&event.what)) ++ended_[static_cast<std::size_t>(end->outcome)];
  };
  tap_all(Line::first);
  if (fold_back_) tap_all(Line::second);
}

void RandomFaults::tap_all(Line line) {
  for (const NodeId id : order_) {
    const auto tap = [this, id, line](const wire::Slice& slice, core::Time, wire::SliceWriter& arriving) {
      pass(id, line, slice, arriving);
    };
    ring_->tap(id, tap, line);
  }
}

// ---- lines ----------------------------------------------------------------------------------

void RandomFaults::pass(NodeId id, Line line, const wire::Slice& slice, wire::SliceWriter& arriving) {
  if (keeps_history_) count_slice(id, line);
  if (quiet_ && sim::is_traffic(slice)) ++slices_when_quiet_;
  if (!quiet_ && once_in(drop_)) return note_slice(Kind::lose_slice, id, line);
  if (quiet_ || slice.bytes.empty() || !once_in(damage_)) return lines_->pass(id, line, slice, arriving);
  const auto bits = static_cast<std::uint8_t>(1 + random(255));
  const std::size_t at = random(static_cast<unsigned>(slice.bytes.size));
  note_slice(Kind::damage_slice, id, line, at, bits);
  lines_->pass_damaged(id, line, slice, at, bits, arriving);
}

// ---- what happens ---------------------------------------------------------------------------

bool RandomFaults::run(std::function<bool()> asked_to_stop) {
  asked_to_stop_ = std::move(asked_to_stop);
  ring_->join([this] { return must_stop(); });
  const unsigned steps = nodes_ <= 16 ? kSteps : kSteps * 16 / nodes_;
  for (unsigned step = 0; step < steps && goes_on(); ++step) {
    act();
    ring_->run_for(Duration{1ns} * random(paced_ ? 12000 : 4000));
    note_violation();
  }
  acted_until_ = ring_->now();
  if (goes_on()) calm_down();
  if (goes_on()) violation_ = sim::not_whole(*ring_);
  if (goes_on()) check_silence();
  if (is_wide_ && goes_on()) send_when_mended();
  return !stopped_;
}

void RandomFaults::note_violation() { violation_ = invariants_->violation(); }

std::uint64_t RandomFaults::hops() const {
  std::uint64_t hops = 0;
  for (const NodeId id : order_) {
    const core::Counters& c = ring_->counters(id);
    hops += c.relayed_data + c.relayed_interrupts + c.sent_data + c.sent_interrupts;
  }
  return hops;
}

void RandomFaults::act() {
  if (once_in(trouble_)) fault();
  if (is_wide_ && trouble_ != 0 && wide(trouble_) == 0) {
    const NodeId node = order_[wide(nodes_)];
    !paced_&& wide(2) == 0 ? stand_still(node) : hold_output(node);
  }
  if (once_in(7))
    interrupt();
  else
    send();
}

void RandomFaults::send() {
  const NodeId source = random_node();
  if (!can_ask(source)) return;
  std::vector<std::uint8_t> data(once_in(3) ? wire::kMaxPayload : 1 + random(wire::kMaxPayload));
  for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random_());
  // Keep this order of draws: otherwise seeds would no longer give the same runs as before.
  const auto priority = static_cast<std::uint8_t>(random(4));
  const NodeId destination = random_destination();
  scenario::Send send;
  send.from = {source};
  send.to = destination;
  send.size = static_cast<unsigned>(data.size());
  send.priority = priority;
  record(send);
  ring_->send(source, destination, data, priority);
}

void RandomFaults::interrupt() {
  const NodeId source = random_node();
  if (!can_ask(source)) return;
  const auto factor = static_cast<std::uint8_t>(random(8));
  const NodeId destination = random_destination();
  scenario::Send send;
  send.from = {source};
  send.to = destination;
  send.interrupt = factor;
  record(send);
  ring_->interrupt(source, destination, factor);
}

void RandomFaults::fault() {
  const NodeId node = random_node();
  switch (random(13)) {
    case 0:
      return kill_or_start(node);
    case 1:
      note(fault::Name::power_cycle, node);
      if (ring_->alive(node)) ring_->kill(node);
      killed_[node] = true;
      return ring_->start(node);
    case 2:
      return freeze_or_thaw(node);
    case 3:
      return ring_->alive(node) ? cut(node) : kill_or_start(node);
    case 4:
    case 5:
      return heal(node);
    case 6:
      note(ring_->cpu_reads(node) ? fault::Name::not_reading : fault::Name::resume, node);
      ring_->set_cpu_reads(node, !ring_->cpu_reads(node));
      return;  // its CPU hangs, or goes on
    case 7:
      note(Kind::cancel, node);
      if (ring_->alive(node)) ring_->cancel(node);
      return;
    case 8:
      note(fault::Name::reset, node);
      if (ring_->alive(node)) ring_->reset_cpu(node);
      return;
    case 9:
      return ring_->alive(node) ? freeze_or_thaw(node) : kill_or_start(node);
    case 10:
    case 11:
    case 12:
      return line_fault(node);
  }
}

// No copy may outlive the time-out of a try: the receiver would take it for a new packet, as would one that has
// restarted meanwhile and knows nothing of the first copy. So a line holds back for a part of the time-out only. The
// part is small where lines duplicate, and where folded lines send packets without an owner round and round.
void RandomFaults::line_fault(NodeId node) {
  const unsigned longest = longest_hold(node, doubles_ ? 32 : fold_back_ ? 16 : 2);
  fault::Fault fault;
  fault.name = once_in(2) ? fault::Name::delay : doubles_ ? fault::Name::duplicate : fault::Name::stall;
  fault.nodes = {node};
  fault.second_line = fold_back_ && once_in(3);
  fault.once_in = 1 + random(10);
  fault.delay = 1ns * (1 + random(longest));
  fault.jitter = 1ns * random(longest);
  fault.lasts = fault.name == fault::Name::stall ? 1ns * (1 + random(longest)) : 1us * (1 + random(1000));
  record(fault);
  lines_->begin(fault);
}

unsigned RandomFaults::longest_hold(NodeId node, int share) const {
  return static_cast<unsigned>(ring_->settings(node).send_timeout() / share / 1ns);
}

// The node stands still for at most as long as a line may hold back, for the same reason: see line_fault().
void RandomFaults::stand_still(NodeId node) {
  const unsigned longest = longest_hold(node, doubles_ ? 32 : 16);
  ring_->pause(node);
  ring_->at(ring_->now() + Duration{1ns} * (1 + wide(longest)), [this, node] { ring_->resume(node); });
}

void RandomFaults::hold_output(NodeId node) {
  if (!ring_->alive(node)) return;
  const unsigned longest = longest_hold(node, doubles_ ? 32 : 16);
  ring_->set_output_ready(node, false);
  ring_->at(ring_->now() + Duration{1ns} * (1 + wide(longest)), [this, node] { ring_->set_output_ready(node, true); });
}

void RandomFaults::cut(NodeId node) {
  if (!fold_back_ || once_in(3)) {
    note(Kind::cut_wire, node);
    return ring_->cut(node);
  }
  const NodeId after = core::node_after(order_, node, 1);
  if (once_in(4)) {
    note(Kind::cut_wire, after, true);
    return ring_->cut(after, Line::second);
  }
  note(Kind::cut_cable, node);
  ring_->cut_cable(node);
}

void RandomFaults::heal(NodeId node) {
  if (!quiet_) note(fold_back_ ? Kind::mend_cable : Kind::mend_wire, node);
  fold_back_ ? ring_->heal_cable(node) : ring_->heal(node);
}

void RandomFaults::kill_or_start(NodeId node) {
  note(ring_->alive(node) ? fault::Name::kill : fault::Name::start, node);
  if (!ring_->alive(node)) return ring_->start(node);
  killed_[node] = true;
  ring_->kill(node);
}

void RandomFaults::freeze_or_thaw(NodeId node) {
  const fault::Name back = killed_[node] ? fault::Name::start : fault::Name::thaw;
  if (!quiet_) note(ring_->alive(node) ? fault::Name::freeze : back, node);
  if (ring_->alive(node)) {
    killed_[node] = false;
    return ring_->freeze(node);
  }
  return killed_[node] ? ring_->start(node) : ring_->thaw(node);
}

// ---- the history ----------------------------------------------------------------------------

void RandomFaults::note(fault::Name name, NodeId node) {
  fault::Fault fault;
  fault.name = name;
  fault.nodes = {node};
  record(fault);
}

void RandomFaults::note(Kind kind, NodeId node, bool second_line) {
  SoakAction action;
  action.kind = kind;
  action.node = node;
  action.second_line = second_line;
  record(action);
}

void RandomFaults::count_slice(NodeId id, Line line) {
  auto& nodes = leaving_[static_cast<std::size_t>(line)];
  if (nodes.empty()) nodes.resize(ring_->size());
  AtInstant& leaving = nodes[id];
  if (leaving.at != ring_->now()) leaving = {ring_->now(), 0};
  ++leaving.slices;
}

void RandomFaults::note_slice(Kind kind, NodeId id, Line line, std::size_t byte, std::uint8_t bits) {
  if (!keeps_history_) return;
  SoakAction action;
  action.kind = kind;
  action.node = id;
  action.second_line = line == Line::second;
  action.nth = leaving_[static_cast<std::size_t>(line)][id].slices;
  action.byte = static_cast<unsigned>(byte);
  action.bits = bits;
  record(action);
}

// ---- afterwards -----------------------------------------------------------------------------

void RandomFaults::calm_down() {
  quiet_ = true;
  lines_->mend_all();
  for (const NodeId node : order_) {
    ring_->set_cpu_reads(node, true);
    heal(node);
    if (!ring_->alive(node)) freeze_or_thaw(node);
  }
  run_until_calm();
}

// Whatever is left over at its end breaks a promise.
void RandomFaults::run_until_calm() {
  sim::run_until_calm(*ring_, *invariants_, slices_when_quiet_, [this] { return must_stop(); });
  if (!stopped_) invariants_->finish();
  note_violation();
}

void RandomFaults::check_silence() {
  slices_when_quiet_ = 0;
  ring_->run_for(20ms);
  note_violation();
  if (!violation_) violation_ = sim::not_silent(*ring_, slices_when_quiet_);
}

// With all mended, every bound is in force again for this traffic.
void RandomFaults::send_when_mended() {
  for (unsigned step = 0; step < kSteps / 8 && goes_on(); ++step) {
    once_in(7) ? interrupt() : send();
    ring_->run_for(Duration{1ns} * random(paced_ ? 12000 : 4000));
    note_violation();
  }
  if (goes_on()) run_until_calm();
}

}  // namespace limb_ring::study
