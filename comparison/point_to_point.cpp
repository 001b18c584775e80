#include "comparison/point_to_point.h"

#include <algorithm>
#include <tuple>

namespace limb_ring::study {

bool PointToPoint::Later::operator()(const Packet& a, const Packet& b) const {
  const auto rank = [this](const Packet& p) {
    return std::make_tuple((*messages)[p.message].priority, p.ready, !p.own, p.order);
  };
  return rank(a) > rank(b);
}

PointToPoint::PointToPoint(const Medium& medium, const std::vector<Message>& messages, unsigned packet, unsigned data,
                           Deliveries& deliveries)
    : medium_(medium),
      messages_(messages),
      packet_time_(medium.bits(8 * packet)),
      data_(data),
      deliveries_(deliveries),
      unsent_(messages.size()),
      lines_(2 * medium.nodes, Line(Later{&messages})) {}

unsigned PointToPoint::line_of(const Message& message) const {
  const unsigned forward = (message.destination + medium_.nodes - message.source) % medium_.nodes;
  const unsigned backward = medium_.nodes - forward;
  const bool back = forward == backward ? message.source % 2 == 1 : backward < forward;
  return 2u * message.source + (back ? 1 : 0);
}

NodeId PointToPoint::end_of(unsigned line) const {
  const unsigned step = line % 2 == 0 ? 1 : medium_.nodes - 1;
  return static_cast<NodeId>((line / 2 + step) % medium_.nodes);
}

void PointToPoint::wait(Packet packet) {
  touched_.push_back(packet.line);
  lines_[packet.line].waiting.push(packet);
}

void PointToPoint::ask(std::size_t message) {
  const Message& m = messages_[message];
  unsent_[message] = std::max(1u, (m.size + data_ - 1) / data_);
  wait({message, line_of(m), true, false, m.asked, order_++});
}

void PointToPoint::arrive(const Event& event) {
  Packet packet = event.packet;
  const NodeId node = end_of(packet.line);
  if (node == messages_[packet.message].destination) {
    if (packet.last) deliveries_.put(packet.message, event.at + packet_time_);
    return;
  }
  packet.line = 2u * node + packet.line % 2;
  packet.ready = event.at;
  wait(packet);
}

void PointToPoint::start(unsigned line, Time now) {
  Line& l = lines_[line];
  if (l.free > now || l.waiting.empty()) return;
  Packet packet = l.waiting.top();
  if (packet.own) packet.last = --unsent_[packet.message] == 0;
  if (!packet.own || packet.last) l.waiting.pop();
  packet.own = false;
  l.free = now + packet_time_;
  events_.push({now + medium_.relay_delay, order_++, true, packet});
  events_.push({l.free, order_++, false, packet});
}

void PointToPoint::carry(bool interrupts) {
  std::size_t next = 0;
  const auto skip = [&] {
    while (next < messages_.size() && messages_[next].interrupt != interrupts) ++next;
    return next < messages_.size() ? messages_[next].asked : core::kNever;
  };
  for (Time now{};;) {
    now = std::min(skip(), events_.empty() ? core::kNever : events_.top().at);
    if (now == core::kNever || !deliveries_.go_on(now)) return;
    for (; skip() == now; ++next) ask(next);
    for (; !events_.empty() && events_.top().at == now; events_.pop()) {
      const Event& event = events_.top();
      if (event.arrival)
        arrive(event);
      else
        touched_.push_back(event.packet.line);
    }
    for (const unsigned line : touched_) start(line, now);
    touched_.clear();
  }
}

std::vector<Time> ResponsiveLink::carry(const Medium& medium, const std::vector<Message>& messages, Time until) const {
  Deliveries deliveries(messages.size(), until);
  PointToPoint(medium, messages, kDataPacket, kPacketData, deliveries).carry(false);
  PointToPoint(medium, messages, kEventPacket, kEventPacket, deliveries).carry(true);
  return deliveries.result();
}

Duration ResponsiveLink::time_to_join(const Medium&) const { return Duration{0}; }

namespace {

bool of_kind(const Message& message, SendQueues::Kind kind) {
  return kind == SendQueues::Kind::all || message.interrupt == (kind == SendQueues::Kind::interrupts);
}

}  // namespace

SendQueues::SendQueues(const Medium& medium, const std::vector<Message>& messages, Kind kind)
    : messages_(messages), nodes_(medium.nodes) {
  for (std::size_t i = 0; i < messages.size(); ++i) {
    remaining_.push_back(messages[i].size);
    if (of_kind(messages[i], kind)) nodes_[messages[i].source].to_come.push_back(i);
  }
}

std::size_t SendQueues::head(NodeId node, Time now) {
  Node& n = nodes_[node];
  for (; !n.to_come.empty() && messages_[n.to_come.front()].asked <= now; n.to_come.pop_front())
    n.asked[class_of(messages_[n.to_come.front()])].push_back(n.to_come.front());
  for (const auto& queue : n.asked)
    if (!queue.empty()) return queue.front();
  return kNone;
}

bool SendQueues::take(std::size_t message, unsigned most) {
  remaining_[message] -= std::min(remaining_[message], most);
  if (remaining_[message] != 0) return false;
  nodes_[messages_[message].source].asked[class_of(messages_[message])].pop_front();
  return true;
}

Time SendQueues::next_asked() const {
  Time next = core::kNever;
  for (const Node& node : nodes_)
    if (!node.to_come.empty()) next = std::min(next, messages_[node.to_come.front()].asked);
  return next;
}

}  // namespace limb_ring::study
