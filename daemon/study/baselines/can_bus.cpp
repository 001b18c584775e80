#include "study/baselines/can_bus.h"

#include <algorithm>
#include <array>

#include "study/baselines/deliveries.h"
#include "study/baselines/send_queues.h"

namespace limb_ring::study {

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
