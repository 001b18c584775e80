#include "study/baselines/send_queues.h"

#include <algorithm>

namespace limb_ring::study {

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
