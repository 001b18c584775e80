#include "study/baselines/ethercat.h"

#include "study/baselines/process_image.h"
#include "study/baselines/slots.h"

namespace limb_ring::study {

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

}  // namespace limb_ring::study
