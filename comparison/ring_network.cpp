#include "comparison/ring_network.h"

#include <algorithm>
#include <stdexcept>

#include "sim/invariants.h"
#include "study/cases.h"
#include "study/model_ring.h"

namespace limb_ring::study {
namespace {

/// Every node but the last sends to its successor for ever.
void load_fully(sim::VirtualRing& ring, const Medium& medium) {
  const std::vector<std::uint8_t> data(medium.payload);
  const unsigned nodes = medium.nodes;
  const auto send = [&ring, nodes, data](NodeId id) { ring.send(id, static_cast<NodeId>((id + 1u) % nodes), data); };
  ring.on_event = [send](NodeId id, const core::Event& event) {
    const auto* end = std::get_if<core::SendEnded>(&event.what);
    if (end && end->outcome != core::Outcome::rejected) send(id);
  };
  for (unsigned id = 0; id < nodes; ++id) send(static_cast<NodeId>(id));
}

}  // namespace

std::vector<Time> RingNetwork::carry(const Medium& medium, const std::vector<Message>& messages, Time until) const {
  sim::WatchedRing ring(ring_options(medium));
  const Pulse pulse(ring, goes_on_);
  join_and_settle(ring, medium);
  RingFeed feed(ring, messages);
  // `until` counts from now, so kNever would overflow the ring's own clock: hence the limit.
  const Duration left = core::kNever - ring.now();
  ring.run_until([&feed] { return feed.done(); }, std::min(until - Time{}, left));
  ring.check();
  return feed.delivered(until);
}

Duration RingNetwork::time_to_join_after(const Medium& medium, Duration wait) const {
  Medium grown = medium;
  ++grown.nodes;
  sim::VirtualRingOptions options = ring_options(grown);
  options.start = false;
  sim::WatchedRing ring(options);
  const Pulse pulse(ring, goes_on_);
  for (unsigned id = 0; id < medium.nodes; ++id) ring.start(static_cast<NodeId>(id));
  join(ring);
  load_fully(ring, medium);
  ring.run_for(wait);
  const auto newcomer = static_cast<NodeId>(medium.nodes);
  const Time on = ring.now();
  ring.start(newcomer);
  join(ring);
  ring.check();
  return ring.now() - on;
}

Duration RingNetwork::time_to_join(const Medium& medium) const {
  constexpr int kInstants = 8, kLapsBefore = 4;
  const Duration lap = data_bound(medium, medium.nodes);
  Duration longest{0};
  for (int i = 0; i < kInstants; ++i)
    longest = std::max(longest, time_to_join_after(medium, kLapsBefore * lap + i * lap / kInstants));
  return longest;
}

namespace {

constexpr unsigned kInside = 8;  // well below a send queue's limit, and never empty in full load
constexpr std::uint8_t kPulseFactor = 1;

}  // namespace

RingFeed::RingFeed(sim::VirtualRing& ring, const std::vector<Message>& messages)
    : ring_(ring),
      messages_(messages),
      start_(ring.now()),
      open_(messages.size()),
      nodes_(ring.size()),
      at_(messages.size(), core::kNever) {
  ring.on_event = [this](NodeId node, const core::Event& event) {
    if (const auto* end = std::get_if<core::SendEnded>(&event.what)) ended(node, *end);
    if (const auto* pin = std::get_if<core::PinPulled>(&event.what)) came({pin->source, node, 0}, event.at);
  };
  ring.on_packet = [this](NodeId node, const core::ReceivedPacket& packet) {
    came({packet.source, node, 1 + packet.priority}, packet.at);
  };
  ask_at_next();
}

void RingFeed::ask_at_next() {
  if (next_ == messages_.size()) return;
  const Time asked = messages_[next_].asked;
  ring_.at(start_ + asked.time_since_epoch(), [this, asked] {
    for (; next_ < messages_.size() && messages_[next_].asked == asked; ++next_) ask(next_);
    ask_at_next();
  });
}

void RingFeed::ask(std::size_t message) {
  const Message& m = messages_[message];
  nodes_[m.source].queues[class_of(m)].outside.push_back(message);
  feed(m.source, class_of(m));
}

void RingFeed::feed(NodeId node, std::size_t kind) {
  Queue& queue = nodes_[node].queues[kind];
  for (; queue.inside < kInside && !queue.outside.empty(); ++queue.inside) {
    const std::size_t message = queue.outside.front();
    queue.outside.pop_front();
    under_way_[{node, messages_[message].destination, kind}].push_back(message);
    nodes_[node].class_of_token[send(messages_[message])] = kind;
  }
}

std::uint32_t RingFeed::send(const Message& message) {
  if (message.interrupt) return ring_.interrupt(message.source, message.destination, kPulseFactor);
  return ring_.send(message.source, message.destination, std::vector<std::uint8_t>(message.size), message.priority);
}

void RingFeed::ended(NodeId node, const core::SendEnded& end) {
  const auto known = nodes_[node].class_of_token.find(end.token);
  if (known == nodes_[node].class_of_token.end()) return;  // the controller's own
  if (end.outcome != core::Outcome::delivered) throw std::logic_error("a send of the virtual ring was not delivered");
  const std::size_t kind = known->second;
  nodes_[node].class_of_token.erase(known);
  --nodes_[node].queues[kind].inside;
  feed(node, kind);
}

void RingFeed::came(const Flow& flow, Time at) {
  auto& waiting = under_way_[flow];
  if (waiting.empty()) throw std::logic_error("a message was delivered twice");
  at_[waiting.front()] = at;
  waiting.pop_front();
  --open_;
}

std::vector<Time> RingFeed::delivered(Time until) const {
  std::vector<Time> out = at_;
  for (Time& at : out)
    if (at != core::kNever) {
      at -= start_.time_since_epoch();
      if (at > until) at = core::kNever;
    }
  return out;
}

}  // namespace limb_ring::study
