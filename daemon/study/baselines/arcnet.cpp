#include "study/baselines/arcnet.h"

#include <algorithm>

#include "study/baselines/deliveries.h"
#include "study/baselines/send_queues.h"

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

}  // namespace limb_ring::study
