#include "comparison/process_image.h"

#include <algorithm>

#include "comparison/network.h"
#include "comparison/point_to_point.h"

namespace limb_ring::study {
namespace {

constexpr unsigned kFront = 8 + 14 + 2;  // preamble, Ethernet header, EtherCAT header
constexpr unsigned kDatagramHeader = 10, kWorkingCounter = 2;
constexpr unsigned kDatagram = kDatagramHeader + kWorkingCounter;
constexpr unsigned kMostDatagrams = 1498, kLeastDatagrams = 44;
constexpr unsigned kFcs = 4, kGap = 12;

unsigned divided_up(unsigned value, unsigned by) { return (value + by - 1) / by; }

}  // namespace

ProcessImage::ProcessImage(const Medium& medium) : nodes_(medium.nodes), slot_(medium.payload) {
  const unsigned most = kMostDatagrams - (kDatagram + nodes_) - kDatagram;
  frames_ = divided_up(nodes_ * slot_, most);
  share_ = divided_up(nodes_ * slot_, frames_);
}

unsigned ProcessImage::length(unsigned frame) const {
  const unsigned data = std::min(share_, nodes_ * slot_ - frame * share_);
  return kFront + std::max(kDatagram + nodes_ + kDatagram + data, kLeastDatagrams) + kFcs;
}

unsigned ProcessImage::pitch(unsigned frame) const { return length(frame) + kGap; }

unsigned ProcessImage::slot(NodeId node) const {
  return kFront + kDatagram + nodes_ + kDatagramHeader + node * slot_ % share_;
}

unsigned ProcessImage::event(NodeId node) const { return kFront + kDatagramHeader + node; }

namespace {

class Master {
 public:
  Master(const Medium& medium, const std::vector<Message>& messages)
      : medium_(medium),
        image_(medium),
        data_(medium, messages, SendQueues::Kind::data, medium.payload),
        events_(medium, messages, SendQueues::Kind::interrupts, 1) {}

  void send_frame(Deliveries& deliveries) {
    for (unsigned id = 0; id < medium_.nodes; ++id) {
      const auto node = static_cast<NodeId>(id);
      if (image_.first_frame(node) == frame_) data_.begin(node, after(image_.slot(node)));
      events_.begin(node, after(image_.event(node)));
    }
    const Time end = after(image_.length(frame_));
    for (unsigned id = 0; id < medium_.nodes; ++id) {
      const auto node = static_cast<NodeId>(id);
      if (image_.last_frame(node) == frame_) data_.end(node, end, deliveries);
      events_.end(node, end, deliveries);
    }
    skip_frame();
  }
  void skip_frame() {
    now_ = after(image_.pitch(frame_));
    frame_ = (frame_ + 1) % image_.frames();
  }
  /// Until the first frame that begins after this one's return.
  void wait_for_return() {
    const Time home = after(image_.length(frame_)) + medium_.nodes * medium_.relay_delay;
    while (now_ < home) skip_frame();
  }
  Time now() const { return now_; }
  /// When that node's slot next passes it.
  Time next_slot(NodeId node) {
    while (image_.first_frame(node) != frame_) skip_frame();
    return after(image_.slot(node)) + node * medium_.relay_delay;
  }

 private:
  Time after(unsigned bytes) const { return now_ + medium_.bits(8 * bytes); }

  const Medium& medium_;
  ProcessImage image_;
  Slots data_, events_;
  Time now_{};
  unsigned frame_ = 0;
};

constexpr unsigned kFramesToSafeOp = 5;

}  // namespace

std::vector<Time> EtherCat::carry(const Medium& medium, const std::vector<Message>& messages, Time until) const {
  Master master(medium, messages);
  Deliveries deliveries(messages.size(), until);
  while (deliveries.go_on(master.now())) master.send_frame(deliveries);
  return deliveries.result();
}

Duration EtherCat::time_to_join(const Medium& medium) const {
  Medium grown = medium;
  ++grown.nodes;
  const std::vector<Message> none;
  Master master(grown, none);
  const auto newcomer = static_cast<NodeId>(medium.nodes);
  // Switched on just behind the first frame.
  const Time on = master.now() + newcomer * medium.relay_delay;
  master.skip_frame();
  for (unsigned i = 0; i < kFramesToSafeOp; ++i) master.wait_for_return();
  return master.next_slot(newcomer) - on;
}

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

namespace {
constexpr NodeId kSlotMaster{0};
}

// The master is before all others and, once the frame is home, behind them.
Duration Slots::to(NodeId destination) const {
  return (destination == kSlotMaster ? medium_.nodes : destination) * medium_.relay_delay;
}

void Slots::begin(NodeId node, Time at_master) {
  Node& n = nodes_[node];
  n.repeated = {};
  if (!n.at_master.empty() && n.at_master.front().home <= at_master) {
    n.repeated = n.at_master.front();
    n.at_master.pop_front();
  }
  n.own = {};
  const std::size_t head = queues_.head(node, at_master + node * medium_.relay_delay);
  if (head != kNone) n.own = {head, queues_.take(head, bytes_), Time{}};
}

void Slots::end(NodeId node, Time at_master, Deliveries& deliveries) {
  Node& n = nodes_[node];
  if (n.repeated.whole) deliveries.put(n.repeated.message, at_master + to(messages_[n.repeated.message].destination));
  if (!n.own.whole) return;  // the parts before the last one take the same way, ahead of it
  const NodeId destination = messages_[n.own.message].destination;
  if (destination == kSlotMaster || destination > node)
    deliveries.put(n.own.message, at_master + to(destination));
  else
    n.at_master.push_back({n.own.message, true, at_master + to(kSlotMaster)});
}

}  // namespace limb_ring::study
