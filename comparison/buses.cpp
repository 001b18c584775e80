#include "comparison/buses.h"

#include <algorithm>
#include <array>

#include "comparison/network.h"
#include "comparison/point_to_point.h"

namespace limb_ring::study {
namespace {

constexpr unsigned kAlert = 6, kCharacter = 11;
constexpr unsigned kToken = kAlert + 3 * kCharacter;
constexpr unsigned kEnquiry = kAlert + 3 * kCharacter;
constexpr unsigned kAck = kAlert + kCharacter;
constexpr unsigned kTwoTurnarounds = 63;  // bit times
constexpr unsigned kShortest = 1, kShortMost = 253, kLongLeast = 257;
constexpr unsigned kBurst = 765 * (8 + 1);
constexpr unsigned kSilence = 205;  // bit times: 82 us at 2.5 Mbit/s

class Bus {
 public:
  Bus(const Medium& medium, const std::vector<Message>& messages, Time until)
      : medium_(medium), queues_(medium, messages), deliveries_(messages.size(), until) {}

  /// The token is at `node`; its turn ends when the next one has it.
  void turn(NodeId node) {
    const std::size_t head = queues_.head(node, now_);
    if (head != SendQueues::kNone) packet(head);
    say(kToken);
  }
  Time now() const { return now_; }
  const Deliveries& deliveries() const { return deliveries_; }

 private:
  /// Until whoever is next may begin.
  void say(unsigned bits) { now_ += medium_.bits(bits) + medium_.bits(kTwoTurnarounds) / 2; }

  void packet(std::size_t message) {
    const unsigned data = std::min(queues_.remaining(message), Arcnet::kPacketData);
    const unsigned bits = Arcnet::packet_bits(std::max(data, kShortest));
    say(kEnquiry);
    say(kAck);
    if (queues_.take(message, data)) deliveries_.put(message, now_ + medium_.bits(bits));
    say(bits);
    say(kAck);
  }

  const Medium& medium_;
  SendQueues queues_;
  Deliveries deliveries_;
  Time now_{};
};

}  // namespace

unsigned Arcnet::packet_bits(unsigned data) {
  if (data <= kShortMost) return kAlert + (4 + 1 + data + 2) * kCharacter;
  return kAlert + (4 + 2 + std::max(data, kLongLeast) + 2) * kCharacter;
}

std::vector<Time> Arcnet::carry(const Medium& medium, const std::vector<Message>& messages, Time until) const {
  Bus bus(medium, messages, until);
  for (unsigned node = 0; bus.deliveries().go_on(bus.now()); node = (node + 1) % medium.nodes)
    bus.turn(static_cast<NodeId>(node));
  return bus.deliveries().result();
}

Duration Arcnet::time_to_join(const Medium& medium) const {
  std::vector<Message> full_load;
  for (unsigned node = 0; node < medium.nodes; ++node) {
    const auto next = static_cast<NodeId>((node + 1) % medium.nodes);
    full_load.push_back({Time{}, static_cast<NodeId>(node), next, medium.payload, 0, false});
  }
  Bus bus(medium, full_load, core::kNever);
  for (unsigned node = 0; node < medium.nodes; ++node) bus.turn(static_cast<NodeId>(node));
  return medium.bits(kBurst + kSilence) + (bus.now() - Time{});
}

namespace {

constexpr std::array<unsigned, 16> kDataSizes{0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
constexpr unsigned kHead = 1 + 11 + 6 + 4;
constexpr unsigned kTail = 3 + 7;
constexpr unsigned kRecessive = 11;  // ACK delimiter, EOF, intermission

unsigned crc_bits(unsigned data) {
  const unsigned counted = 4 + (data <= 16 ? 17 : 21);
  return counted + 1 + counted / 4;
}

unsigned identifier(const Message& message) { return static_cast<unsigned>(class_of(message)) << 8 | message.source; }

/// Index of the message whose frame wins at `now`, or kNone.
std::size_t arbitrate(const Medium& medium, const std::vector<Message>& messages, SendQueues& queues, Time now) {
  std::size_t winner = SendQueues::kNone;
  for (unsigned node = 0; node < medium.nodes; ++node) {
    const std::size_t head = queues.head(static_cast<NodeId>(node), now);
    if (head == SendQueues::kNone) continue;
    if (winner == SendQueues::kNone || identifier(messages[head]) < identifier(messages[winner])) winner = head;
  }
  return winner;
}

}  // namespace

unsigned CanBus::frame_bits(unsigned data) {
  const unsigned padded = *std::lower_bound(kDataSizes.begin(), kDataSizes.end(), data);
  return kHead + 8 * padded + crc_bits(padded) + kTail;
}

std::vector<Time> CanBus::carry(const Medium& medium, const std::vector<Message>& messages, Time until) const {
  SendQueues queues(medium, messages);
  Deliveries deliveries(messages.size(), until);
  for (Time now{}; deliveries.go_on(now);) {
    const std::size_t winner = arbitrate(medium, messages, queues, now);
    if (winner == SendQueues::kNone) {
      now = queues.next_asked();
      continue;
    }
    const unsigned data = std::min(queues.remaining(winner), kFrameData);
    now += medium.bits(frame_bits(data));
    if (queues.take(winner, data)) deliveries.put(winner, now);
    now += medium.bits(kIntermission);
  }
  return deliveries.result();
}

Duration CanBus::time_to_join(const Medium& medium) const {
  return medium.bits(kRecessive + frame_bits(std::min(medium.payload, kFrameData)) + kIntermission);
}

}  // namespace limb_ring::study
