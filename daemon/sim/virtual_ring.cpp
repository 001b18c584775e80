#include "sim/virtual_ring.h"

#include <algorithm>
#include <utility>

namespace limb_ring::sim {

using core::kNever;
using wire::Slice;
using wire::SliceWriter;

namespace {

/// One above the largest id.
unsigned ids_of(const VirtualRingOptions& options) {
  if (options.order.empty()) return options.nodes;
  return *std::max_element(options.order.begin(), options.order.end()) + 1u;
}

}  // namespace

// The core knows time only as spans of its settings, so a fast clock is the same as shorter spans.
void let_drift(core::Settings& s, int ppm) {
  s.lap = s.worst_lap();
  s.all_delays = s.all_delays.count() != 0 ? s.all_delays : s.nodes() * s.relay_delay;
  for (Duration* kept :
       {&s.lap, &s.all_delays, &s.send_timeout_least, &s.refused_for, &s.refused_backoff, &s.refused_backoff_most,
        &s.queue_timeout, &s.stall, &s.beacon, &s.break_grace, &s.fold_permission, &s.unconfirmed_pace})
    *kept = *kept * 1'000'000 / (1'000'000 + ppm);
}

VirtualRing::VirtualRing(const VirtualRingOptions& options)
    : options_(options), nodes_(ids_of(options)), wakes_(ids_of(options)) {
  if (options_.order.empty())
    for (unsigned id = 0; id < options.nodes; ++id) options_.order.push_back(static_cast<NodeId>(id));
  for (unsigned id = 0; id < size(); ++id) make_node(static_cast<NodeId>(id));  // also for ids that no node has
  for (const NodeId id : order()) {
    nodes_[id].delay_line = delay_line_of(nodes_[id].controller->settings().relay_delay);
    nodes_[id].alive = options.start;
  }
  if (!options.start) return;
  for (const NodeId id : order()) {
    node(id).set_cpu_present(true);
    for (const Line line : lines()) connect(id, line);
  }
}

std::unique_ptr<NetworkController> VirtualRing::make_node(NodeId id) {
  Node& n = nodes_[id];
  auto former = std::exchange(n.controller, std::make_unique<NetworkController>(settings_of(id), time_of(id)));
  n.observer_tap = std::make_unique<ObserverTap>(*this, id);
  if (!observers_.empty()) n.controller->set_tap(n.observer_tap.get());
  return former;
}

// Without an observer nothing is tapped, which costs nothing.
void VirtualRing::add_observer(Observer& observer) {
  observers_.push_back(&observer);
  for (Node& n : nodes_) n.controller->set_tap(n.observer_tap.get());
}

core::Settings VirtualRing::settings_of(NodeId id) const {
  core::Settings settings;
  settings.id = id;
  settings.order = options_.order;
  settings.boot = next_boot(id);
  settings.byte_time_in = settings.byte_time_out = options_.byte_time;
  settings.relay_delay = options_.relay_delay;
  settings.wired = {true, true, true, false, false, false, false, false};  // as pins are by default
  options_.adjust(settings);
  if (options_.drift) let_drift(settings, options_.drift(id));
  return settings;
}

// The wall clock shows a time of its own, which goes on by 4.3 s with each start, unless it is set. Each life has the
// incarnation after that of the one before; the first one has 0.
std::uint64_t VirtualRing::next_boot(NodeId id) const {
  const Node& n = nodes_[id];
  constexpr std::int64_t kRoundedUpBy = 4;
  const auto shown = static_cast<std::int64_t>((n.starts + 1) << 32 | std::uint64_t{id} << 24) - kRoundedUpBy;
  const std::int64_t wall = std::max<std::int64_t>(shown + core::whole_nanoseconds(n.wall_ahead).count(), 0);
  return wire::next_boot(n.controller ? n.controller->membership().boot() : 3, static_cast<std::uint64_t>(wall));
}

// ---- traffic ------------------------------------------------------------------------------

std::uint32_t VirtualRing::send(NodeId id, NodeId destination, const std::vector<std::uint8_t>& data,
                                std::uint8_t priority, std::uint8_t channel) {
  core::SendRequest request;
  request.owner = kUser;
  request.token = nodes_[id].next_token++;
  request.destination = destination;
  request.priority = wire::Priority{priority};
  request.channel = wire::ChannelId{channel};
  request.data = {data.data(), data.size()};
  for (Observer* observer : observers_) observer->asked(id, request, now_);
  node(id).apply(core::input::Send{request}, time_of(id));
  return request.token;
}

std::uint32_t VirtualRing::interrupt(NodeId id, NodeId destination, std::uint8_t factor) {
  const core::InterruptRequest request{kUser, nodes_[id].next_token++, destination, wire::Factor{factor}};
  for (Observer* observer : observers_) observer->asked(id, request, now_);
  node(id).apply(core::input::Interrupt{request}, time_of(id));
  return request.token;
}

std::uint32_t VirtualRing::pull(NodeId id, unsigned input) {
  const std::uint32_t token = nodes_[id].next_token++;
  const auto& inputs = nodes_[id].controller->settings().inputs;
  if (input < inputs.size() && inputs[input])
    for (Observer* observer : observers_)
      observer->asked(id, core::InterruptRequest{kUser, token, inputs[input]->destination, inputs[input]->factor},
                      now_);
  node(id).apply(core::input::Pull{kUser, token, input}, time_of(id));
  return token;
}

void VirtualRing::reset_cpu(NodeId id) {
  tell(id, Incident::cpu_reset);
  node(id).apply(core::input::CpuReset{kUser}, time_of(id));
}

void VirtualRing::set_cpu_present(NodeId id, bool present) {
  for (Observer* observer : observers_) observer->cpu_present(id, present, now_);
  node(id).set_cpu_present(present);
}

void VirtualRing::set_cpu_reads(NodeId id, bool reads) {
  nodes_[id].cpu_reads = reads;
  touch(id);  // what has waited is taken at once
}

void VirtualRing::cancel(NodeId id) {
  tell(id, Incident::cancelled);
  node(id).apply(core::input::Cancel{kUser}, time_of(id));
}

const core::SendEnded* VirtualRing::ended(NodeId id, std::uint32_t token) const {
  for (const core::Event& event : nodes_[id].log.events) {
    const auto* end = std::get_if<core::SendEnded>(&event.what);
    if (end && end->token == token) return end;
  }
  return nullptr;
}

// ---- time ---------------------------------------------------------------------------------

void VirtualRing::at(Time time, std::function<void()> action) {
  actions_.push({std::max(time, now_), order_++, std::move(action)});
}

Time VirtualRing::next_instant() const {
  Time next = wakes_.earliest();
  for (const DelayLine& delay_line : delay_lines_) next = std::min(next, delay_line.next());
  return actions_.empty() ? next : std::min(next, actions_.top().at);
}

void VirtualRing::run_until(Time until) {
  settle_touched();
  while (next_instant() <= until) step();
  now_ = std::max(now_, until);
}

bool VirtualRing::run_until(const std::function<bool()>& done, Duration limit) {
  const Time until = now_ + limit;
  settle_touched();
  while (!done()) {
    if (next_instant() > until) return false;
    step();
  }
  return true;
}

bool VirtualRing::join(const std::function<bool()>& asked_to_stop) {
  constexpr Duration kStep = std::chrono::milliseconds(1), kLongest = std::chrono::seconds(10);
  const Time began = now_;
  for (Duration waited = kStep; waited <= kLongest && !asked_to_stop(); waited += kStep)
    if (run_until([this] { return joined(); }, began + waited - now_)) return true;
  return false;
}

bool VirtualRing::joined() const {
  return std::all_of(nodes_.begin(), nodes_.end(), [](const Node& n) {
    return !n.alive || n.guest != nullptr || n.controller->membership().accepts_sends();
  });
}

// One instant: everything that arrives at it, then every node it touched decides.
void VirtualRing::step() {
  now_ = next_instant();
  act();
  for (DelayLine& delay_line : delay_lines_)
    while (delay_line.next() == now_) deliver(delay_line.pop());
  wakes_.each_at(now_, [this](unsigned id) { touch(static_cast<NodeId>(id)); });
  settle_touched();
}

void VirtualRing::act() {
  while (!actions_.empty() && actions_.top().at == now_) {
    const auto what = actions_.top().what;
    actions_.pop();
    what();
  }
}

void VirtualRing::deliver(const DelayLine::Arrival& arrival) {
  Node& to = nodes_[arrival.to];
  if (!to.alive || wire_of(arrival.from, arrival.line).epoch != arrival.epoch) return;
  if (to.paused) return to.waiting.push_back(arrival);
  if (to.guest != nullptr) return deliver_to_guest(arrival);
  NetworkController& controller = *to.controller;
  const Time now = time_of(arrival.to);
  wire::each_slice(arrival.slices.view(), [&](const Slice& slice) {
    if (const auto word = wire::fold_word(slice))
      for (Observer* observer : observers_) observer->word_arrives(arrival.to, *word, arrival.line, now_);
    controller.receive(arrival.line, slice, now);
  });
  // On a line with a data rate most of what comes in has to wait for its turn: then there is nothing to
  // be done but to note when.
  const Time deadline = controller.next_deadline(now);
  if (deadline <= now || controller.has_output(now)) return touch(arrival.to);
  wakes_.set(arrival.to, in_ring(arrival.to, deadline));
}

void VirtualRing::settle_touched() {
  while (!touched_.empty()) {
    const NodeId id = touched_.pop();
    Node& node = nodes_[id];
    if (node.alive && !node.paused) settle(id, node);
  }
}

void VirtualRing::deliver_to_guest(const DelayLine::Arrival& arrival) {
  wire::each_slice(arrival.slices.view(), [&](const Slice& slice) {
    for (Observer* observer : observers_) observer->arrives(arrival.to, slice, now_);
    nodes_[arrival.to].guest->receive(slice, now_);
  });
  touch(arrival.to);
}

void VirtualRing::settle_guest(NodeId id, Node& node) {
  node.guest->give_out(of_guest_);
  if (of_guest_.empty()) return;
  tell_leaving(id, of_guest_.view());
  put_on_line(id, Line::first, node.lines[0], of_guest_);
}

void VirtualRing::settle(NodeId id, Node& node) {
  if (node.guest != nullptr) return settle_guest(id, node);
  NetworkController& controller = *node.controller;
  const Time now = time_of(id);
  controller.apply(core::input::Timeout{}, now);
  controller.apply(core::input::Run{}, now);
  for (const Line line : controller.lines())
    if (SliceWriter& slices = controller.output(line); !slices.empty())
      put_on_line(id, line, node.lines[static_cast<std::size_t>(line)], slices);
  if (controller.has_output(now)) give_out(id);
  wakes_.set(id, std::max(in_ring(id, controller.next_deadline(now)), now_));
}

void VirtualRing::put_on_line(NodeId id, Line line, const Wire& out, SliceWriter& slices) {
  if (!out.tap) return carry_off(id, line, out, slices);
  pass_through_tap(id, line, slices);
  slices.clear();
  carry_off(id, line, out, tapped_);
}

void VirtualRing::carry_off(NodeId id, Line line, const Wire& out, SliceWriter& slices) {
  if (slices.empty() || out.cut || out.successor < 0) return slices.clear();
  const auto to = static_cast<NodeId>(out.successor);
  delay_lines_[nodes_[to].delay_line].put(now_, id, to, out.epoch, line, slices);
}

void VirtualRing::put_late(NodeId id, SliceWriter& slices, Line line) {
  tell(id, Incident::late_slice, line);
  carry_off(id, line, wire_of(id, line), slices);
}

void VirtualRing::tell_leaving(NodeId id, wire::ByteView slices) {
  wire::each_slice(slices, [&](const Slice& slice) {
    for (Observer* observer : observers_) observer->leaves(id, slice, now_);
  });
}

void VirtualRing::pass_through_tap(NodeId id, Line line, SliceWriter& slices) {
  wire::each_slice(slices.view(), [&](const Slice& slice) {
    const std::size_t before = tapped_.view().size;
    wire_of(id, line).tap(slice, now_, tapped_);
    if (!observers_.empty()) tell_tapped(id, line, slice, before);
  });
}

void VirtualRing::tell_tapped(NodeId id, Line line, const wire::Slice& slice, std::size_t before) {
  const wire::ByteView put = tapped_.view().from(before);
  if (put.empty()) return tell(id, Incident::lost_slice, line);
  const wire::ByteView bytes = put.from(wire::kSliceHeaderSize);
  const bool same = bytes.size == slice.bytes.size && std::equal(bytes.begin(), bytes.end(), slice.bytes.begin());
  if (!same) tell(id, Incident::damaged_slice, line);
}

void VirtualRing::give_out(NodeId id) {
  NetworkController& controller = *nodes_[id].controller;
  core::Event event;
  while (controller.take_event(time_of(id), event)) {
    tell_by_ring_clock(id, event);
    for (Observer* observer : observers_) observer->event(id, event);
    if (options_.keep_logs) nodes_[id].log.events.push_back(event);
    on_event(id, event);
    touch(id);
  }
  core::ReceivedPacket packet;
  while (nodes_[id].cpu_reads && take(id, packet)) {
  }
  on_given_out(id);
}

bool VirtualRing::take(NodeId id, core::ReceivedPacket& packet) {
  if (!nodes_[id].controller->take(time_of(id), packet)) return false;
  packet.at = in_ring(id, packet.at);
  for (Observer* observer : observers_) observer->packet(id, packet);
  if (options_.keep_logs) nodes_[id].log.packets.push_back(packet);
  on_packet(id, packet);
  touch(id);
  return true;
}

std::size_t VirtualRing::delay_line_of(Duration delay) {
  for (std::size_t i = 0; i < delay_lines_.size(); ++i)
    if (delay_lines_[i].delay() == delay) return i;
  delay_lines_.emplace_back(delay);
  return delay_lines_.size() - 1;
}

}  // namespace limb_ring::sim
