#include "client/inbox.h"

#include <algorithm>
#include <utility>

namespace limb_ring::client {

namespace {

constexpr std::size_t kMaxObserved = 4096;
constexpr std::size_t kMaxOthers = 65536;

}  // namespace

void Inbox::put(Packet packet) {
  packet_turns_.push_back(arrivals_++);
  packets_[packet.priority].push_back(std::move(packet));
}

void Inbox::put(Interrupt interrupt) { interrupts_.push_back(interrupt); }

void Inbox::put(Observed observed) {
  if (observed_ >= kMaxObserved) {
    ++observed_lost_;
    return;
  }
  tell_lost();
  ++observed_;
  put_other(std::move(observed));
}

void Inbox::put(ObservedLost lost) {
  observed_lost_ += lost.count;
  if (observed_ < kMaxObserved) tell_lost();
}

void Inbox::put(CapturedPacket captured) {
  if (captured_ >= kMaxObserved) {
    captured_lost_ += 1 + captured.lost_before;
    return;
  }
  captured.lost_before += std::exchange(captured_lost_, 0);
  ++captured_;
  put_other(std::move(captured));
}

void Inbox::put_other(Message message) { others_.push_back({arrivals_++, std::move(message)}); }

void Inbox::tell_lost() {
  const std::uint64_t lost = std::exchange(observed_lost_, 0);
  if (lost > 0) put_other(ObservedLost{lost});
}

bool Inbox::packet_is_next() const {
  if (packet_turns_.empty()) return false;
  return others_.empty() || packet_turns_.front() < others_.front().arrival;
}

Packet Inbox::take_packet() {
  packet_turns_.pop_front();
  auto& queue = *std::find_if(packets_.begin(), packets_.end(), [](const auto& one) { return !one.empty(); });
  Packet packet = std::move(queue.front());
  queue.pop_front();
  return packet;
}

Message Inbox::take_other() {
  Message message = std::move(others_.front().message);
  others_.pop_front();
  if (std::holds_alternative<Observed>(message)) --observed_;
  if (std::holds_alternative<CapturedPacket>(message)) --captured_;
  if (others_.empty()) tell_lost();
  return message;
}

std::optional<Message> Inbox::take() {
  if (!interrupts_.empty()) {
    const Interrupt interrupt = interrupts_.front();
    interrupts_.pop_front();
    return interrupt;
  }
  if (packet_is_next()) return take_packet();
  if (others_.empty()) return std::nullopt;
  return take_other();
}

template <typename Kind>
std::optional<Kind> Inbox::take_with_token(std::uint32_t token) {
  const auto found = std::find_if(others_.begin(), others_.end(), [token](const Other& other) {
    const Kind* kind = std::get_if<Kind>(&other.message);
    return kind != nullptr && kind->token == token;
  });
  if (found == others_.end()) return std::nullopt;
  Kind kind = std::get<Kind>(std::move(found->message));
  others_.erase(found);
  return kind;
}

std::optional<Result> Inbox::take_result(std::uint32_t token) { return take_with_token<Result>(token); }

std::optional<Reply> Inbox::take_reply(std::uint32_t token) { return take_with_token<Reply>(token); }

bool Inbox::empty() const { return interrupts_.empty() && packet_turns_.empty() && others_.empty(); }

// Packets too: they are few, but for a daemon that gives more than it was granted.
bool Inbox::full() const { return others_.size() + interrupts_.size() + packet_turns_.size() >= kMaxOthers; }

}  // namespace limb_ring::client
