#include "core/random_run.h"

#include <algorithm>
#include <cstring>
#include <sstream>

namespace limb_ring::core {
namespace {

constexpr unsigned kSteps = 1200;
constexpr unsigned kInsertionBuffer = 8;

}  // namespace

RandomRun::RandomRun(std::uint64_t seed) : seed_(seed), random_(seed) {
  choose_mix();
  make_ring();
  lives_.assign(nodes_, 0);
  killed_.assign(nodes_, false);
  was_away_.assign(nodes_, false);
}

void RandomRun::choose_mix() {
  nodes_ = chance(0.7) ? 16 : 2 + random(15);
  paced_ = chance(0.5);
  const double levels[] = {0, 0.0005, 0.005, 0.03};
  drop_ = levels[random(4)];
  damage_ = levels[random(4)];
  trouble_ = levels[random(4)];
}

std::string RandomRun::describe() const {
  std::ostringstream out;
  out << "seed " << seed_ << ": " << nodes_ << " nodes, " << (paced_ ? "paced" : "unpaced") << ", drop " << drop_
      << ", damage " << damage_ << ", trouble " << trouble_;
  return out.str();
}

unsigned RandomRun::ended(Outcome outcome) const {
  return static_cast<unsigned>(std::count_if(sent_.begin(), sent_.end(), [&](const Sent& sent) {
    return sent.ended && sent.end.outcome == outcome;
  }));
}

void RandomRun::make_ring() {
  VirtualRingOptions options;
  options.nodes = nodes_;
  options.byte_time = paced_ ? Duration{8ns} : Duration{0};
  options.relay_delay = 512ns;
  options.adjust = [this](Settings& s) {
    s.send_timeout_least = paced_ ? Duration{0} : Duration{100us};
    s.refused_for = 2ms;
    s.refused_backoff = 20us;
    s.refused_backoff_most = 300us;
    s.queue_timeout = 20ms;
    s.stall = 50us;
    s.beacon = 1ms;
    s.break_grace = 300us;
    s.insertion_buffer = kInsertionBuffer;
    s.receive_buffers = 3;
    s.send_queue = 6;
    s.wired = {true, false, true, true, true, true, true, true};
  };
  ring_ = std::make_unique<VirtualRing>(options);
  ring_->on_event = [this](NodeId node, const Event& event) { on_event(node, event); };
  ring_->on_packet = [this](NodeId node, const ReceivedPacket& packet) { on_packet(node, packet); };
  arm_lines();
}

// ---- lines ----------------------------------------------------------------------------------

void RandomRun::arm_lines() {
  for (unsigned node = 0; node < nodes_; ++node)
    ring_->tap(static_cast<NodeId>(node), [this, node](const wire::Slice& slice, Time, wire::SliceWriter& arriving) {
      pass(static_cast<NodeId>(node), slice, arriving);
    });
}

void RandomRun::pass(NodeId node, const wire::Slice& slice, wire::SliceWriter& arriving) {

  static_cast<void>(node);
  if (quiet_) {
    const bool control = slice.kind != wire::SliceKind::interrupt && slice.bytes.size >= 13 &&
                         slice.bytes[slice.bytes.size - 5] >> 2 == 1;
    const bool part = slice.kind == wire::SliceKind::start;  // its end tells
    if (!control && !part) ++slices_when_quiet_;
  }
  if (!quiet_ && chance(drop_)) return;
  std::uint8_t* bytes = arriving.put_space(slice.kind, slice.bytes.size);
  if (slice.bytes.size == 0) return;
  std::memcpy(bytes, slice.bytes.data, slice.bytes.size);
  if (!quiet_ && chance(damage_))
    bytes[random(static_cast<unsigned>(slice.bytes.size))] ^= static_cast<std::uint8_t>(1u << random(8));
}

// ---- what happens ---------------------------------------------------------------------------

void RandomRun::run() {
  ring_->join();
  for (unsigned step = 0; step < kSteps; ++step) {
    act();
    ring_->run_for(Duration{1ns} * random(paced_ ? 12000 : 4000));
  }
  calm_down();
  check_ends();
  check_interrupts();
  check_silence();
}

void RandomRun::act() {
  if (chance(trouble_)) fault();
  if (chance(0.15))
    interrupt();
  else
    send();
}

NodeId RandomRun::random_destination() {
  return chance(0.2) ? wire::kBroadcast : random_node();
}

void RandomRun::send() {
  const NodeId source = random_node();
  if (!ring_->alive(source)) return;
  const auto serial = static_cast<std::uint32_t>(sent_.size());
  Bytes data(4 + (chance(0.3) ? 508 : random(509)));
  wire::store_u32(data.data(), serial);
  for (std::size_t i = 4; i < data.size(); ++i) data[i] = static_cast<std::uint8_t>(random_());
  const auto priority = static_cast<std::uint8_t>(random(4));
  sent_.push_back({source, random_destination(), priority, lives_[source], data, false, {}, {}});
  const std::uint32_t token = ring_->send(source, sent_.back().destination, data, priority);
  serials_[{source, token}] = serial;
}

void RandomRun::interrupt() {
  const NodeId source = random_node();
  if (!ring_->alive(source)) return;
  const NodeId destination = random_destination();
  const auto factor = static_cast<std::uint8_t>(random(8));
  const std::uint32_t token = ring_->interrupt(source, destination, factor);
  interrupts_[{source, token}] = {source, destination, factor, lives_[source], false, {}};
}

void RandomRun::fault() {
  const NodeId node = random_node();
  switch (random(8)) {
    case 0: return kill(node);
    case 1: return restart(node);
    case 2: return freeze_or_return(node);
    case 3: return ring_->alive(node) ? ring_->cut(node) : restart(node);
    case 4:
    case 5: return ring_->heal(node);
    case 6: ring_->cpu_reads[node] = !ring_->cpu_reads[node]; return;
    case 7: ring_->node(node).cancel(1, ring_->now()); return;
  }
}

void RandomRun::freeze_or_return(NodeId node) {
  was_away_[node] = true;
  if (ring_->alive(node)) return ring_->freeze(node);
  if (killed_[node]) return restart(node);
  ring_->thaw(node);
}

// What the NC has taken counts as arrived, though its CPU has not read it yet.
void RandomRun::read_all(NodeId node) {
  ReceivedPacket packet;
  while (ring_->node(node).take(kNever, packet)) on_packet(node, packet);
}

void RandomRun::kill(NodeId node) {
  if (!ring_->alive(node)) return;
  read_all(node);
  killed_[node] = was_away_[node] = true;
  ring_->kill(node);
}

void RandomRun::restart(NodeId node) {
  kill(node);
  if (!killed_[node]) read_all(node);  // it was frozen
  was_away_[node] = true;
  ++lives_[node];
  killed_[node] = false;
  ring_->start(node);
}

// ---- what comes out -------------------------------------------------------------------------

void RandomRun::on_event(NodeId node, const Event& event) {
  if (const auto* pin = std::get_if<PinPulled>(&event.what)) ++pulls_[{pin->source, node, pin->factor}];
  if (const auto* change = std::get_if<StateChanged>(&event.what)) on_state(node, change->after);
  const auto* end = std::get_if<SendEnded>(&event.what);
  if (!end) return;
  const Key key{node, end->token};
  auto& ended = end->interrupt ? interrupts_.at(key).ended : sent_[serials_.at(key)].ended;
  if (ended) complain("two results for one send");
  ended = true;
  (end->interrupt ? interrupts_.at(key).end : sent_[serials_.at(key)].end) = *end;
}

// A node that starts over forgets what it took, and still nothing comes twice.
void RandomRun::on_state(NodeId node, NodeState state) {
  if (state == NodeState::starting) was_away_[node] = true;
}

void RandomRun::on_packet(NodeId node, const ReceivedPacket& packet) {
  const wire::ByteView bytes = packet.bytes();
  if (bytes.size < 4 || wire::load_u32(bytes.data) >= sent_.size()) return complain("a packet nobody sent");
  const std::uint32_t serial = wire::load_u32(bytes.data);
  Sent& sent = sent_[serial];
  if (Bytes(bytes.begin(), bytes.end()) != sent.data || packet.source != sent.source ||
      packet.destination != sent.destination || packet.priority != sent.priority)
    complain("packet " + std::to_string(serial) + " arrived changed");
  if (++sent.receipts[{node, lives_[node]}] > 1)
    complain("packet " + std::to_string(serial) + " delivered twice to node " + std::to_string(node));
  check_order(node, packet, serial);
}

void RandomRun::check_order(NodeId node, const ReceivedPacket& packet, std::uint32_t serial) {
  const Sent& sent = sent_[serial];
  std::uint32_t& newest =
      newest_[{node, lives_[node], sent.source, sent.source_life, std::uint64_t{packet.priority}}];
  if (serial < newest) complain("packet " + std::to_string(serial) + " came after " + std::to_string(newest));
  newest = serial;
}

void RandomRun::calm_down() {
  quiet_ = true;
  for (unsigned id = 0; id < nodes_; ++id) {
    const auto node = static_cast<NodeId>(id);
    ring_->cpu_reads[id] = true;
    ring_->heal(node);
    if (ring_->alive(node)) continue;
    freeze_or_return(node);
  }
  ring_->run_for(200ms);
  for (unsigned id = 0; id < nodes_; ++id) {
    const Membership& m = ring_->node(static_cast<NodeId>(id)).membership();
    if (m.state() != NodeState::up || m.ring_size() != nodes_)
      complain("node " + std::to_string(id) + " is " + to_string(m.state()) + " in a ring of " +
               std::to_string(m.ring_size()) + " after all was mended");
  }
}

}  // namespace limb_ring::core
