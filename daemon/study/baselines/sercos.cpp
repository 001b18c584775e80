#include "study/baselines/sercos.h"

#include "study/baselines/deliveries.h"
#include "study/baselines/send_queues.h"

namespace limb_ring::study {

namespace {

constexpr NodeId kSercosMaster{0};
constexpr unsigned kFraming = 1 + 1 + 2 + 1;
constexpr unsigned kMst = kFraming + 1;
constexpr unsigned kRecordHead = 2 + 2;
constexpr unsigned kEmptyTelegram = kFraming + kRecordHead;  // an AT, or an MDT for one slave, without data

/// Of all telegrams, at the line's rate.
struct Lengths {
  explicit Lengths(const Medium& medium)
      : mst(medium.bits(8 * kMst)),
        at(medium.bits(8 * (kFraming + kRecordHead + medium.payload))),
        mdt(medium.bits(8 * (kFraming + (medium.nodes - 1) * kRecordHead + medium.nodes * medium.payload))),
        lap(medium.nodes * medium.relay_delay) {}
  Duration mst, at, mdt, lap;
};

/// One kind of what is sent: messages, or real-time bits.
class Traffic {
 public:
  Traffic(const Medium& medium, const std::vector<Message>& messages, SendQueues::Kind kind)
      : medium_(medium), messages_(messages), queues_(medium, messages, kind) {}

  /// The node's part of the cycle is filled at `now`.
  /// @param at_home when the master has it, @param mdt_end when the MDT's end leaves the master
  void send(NodeId node, Time now, Time at_home, Time mdt_end, Deliveries& deliveries) {
    const std::size_t head = queues_.head(node, now);
    if (head == SendQueues::kNone || !queues_.take(head, medium_.payload)) return;
    const NodeId destination = messages_[head].destination;
    deliveries.put(head, destination == kSercosMaster ? at_home : mdt_end + destination * medium_.relay_delay);
  }

 private:
  const Medium& medium_;
  const std::vector<Message>& messages_;
  SendQueues queues_;
};

/// @return the end of the cycle that begins at `start`
Time run_cycle(const Medium& medium, const Lengths& lengths, Time start, Traffic& traffic, Deliveries& deliveries) {
  const Time slots = start + lengths.mst;  // at a slave h hops away: h * d later
  const Time mdt = slots + (medium.nodes - 1) * lengths.at + lengths.lap;
  for (unsigned id = 1; id < medium.nodes; ++id)
    traffic.send(static_cast<NodeId>(id), slots + (id - 1) * lengths.at + id * medium.relay_delay,
                 slots + id * lengths.at + lengths.lap, mdt + lengths.mdt, deliveries);
  traffic.send(kSercosMaster, mdt, mdt, mdt + lengths.mdt, deliveries);
  return mdt + lengths.mdt;
}

constexpr unsigned kMstsHome = 10;
constexpr unsigned kParameters = 8, kStepsPerParameter = 2;

}  // namespace

std::vector<Time> Sercos::carry(const Medium& medium, const std::vector<Message>& messages, Time until) const {
  const Lengths lengths(medium);
  Traffic data(medium, messages, SendQueues::Kind::data);
  Traffic bits(medium, messages, SendQueues::Kind::interrupts);
  Deliveries deliveries(messages.size(), until);
  for (Time now{}; deliveries.go_on(now);) {
    run_cycle(medium, lengths, now, bits, deliveries);
    now = run_cycle(medium, lengths, now, data, deliveries);
  }
  return deliveries.result();
}

Duration Sercos::time_to_join(const Medium& medium) const {
  Medium grown = medium;
  ++grown.nodes;
  const Lengths lengths(grown);
  const unsigned slaves = grown.nodes - 1;
  const Duration one_slave = lengths.mst + 2 * medium.bits(8 * kEmptyTelegram) + lengths.lap;
  const Duration all_slaves = lengths.mst + slaves * lengths.at + lengths.mdt + lengths.lap;
  Duration time = kMstsHome * (lengths.mst + lengths.lap);
  time += slaves * one_slave;
  time += slaves * kParameters * kStepsPerParameter * one_slave;
  time += kStepsPerParameter * all_slaves;
  return time + lengths.mst + (slaves - 1) * lengths.at + slaves * medium.relay_delay;
}

}  // namespace limb_ring::study
