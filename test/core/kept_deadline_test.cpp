// A node keeps the deadline of its next task, so a packet that only passes needs no look at all tasks. Two nodes get
// the same random inputs, and one of them is made to look at everything each time. They never differ.
#include <random>
#include <utility>

#include "core/archive.h"
#include "core/solo_node.h"

namespace limb_ring::core {
namespace {

constexpr unsigned kSeeds = 12, kInputs = 200;
/// The first so many inputs of give().
constexpr unsigned kDisruptive = 5;

class AnyInputs {
 public:
  AnyInputs(unsigned seed, Duration byte_time) : random_(seed), node_(settings(byte_time, seed % 2 * 10ms)) {
    node_.set_cpu_present(true);
    node_.input_up(0_id, now_);
    node_.output_up(2_id, now_);
    go_on_for(1us);
    come_home();
    go_on_for(1us);
  }

  void give_one() {
    put_out_.clear();
    give(any(20));
    if (any(4) != 0) take_events();
    keep(node_.line().view());
    node_.line().clear();
  }
  /// A node looks at everything once its state was written down.
  Bytes write_down() {
    Bytes state(1 << 19);
    StateWriter writer(state.data(), state.size());
    node_.archive(writer);
    EXPECT_FALSE(writer.failed());
    return state;
  }
  bool is_up() const { return node_.membership().state() == NodeState::up; }
  Time deadline() const { return node_.next_deadline(now_); }
  const Bytes& put_out() const { return put_out_; }

 private:
  /// As whoever drives a node does: it wakes when it has asked for it.
  void go_on_for(Duration duration) {
    const Time until = now_ + duration;
    for (Time next = now_; next <= until; next = std::max(now_ + 1ns, node_.next_deadline(now_))) {
      now_ = next;
      node_.handle_timeout(now_);
      node_.run(now_);
      keep(node_.line().view());
      node_.line().clear();
    }
    now_ = until;
  }
  /// @param beacon their period, 0: none, which would often be the first deadline of all
  static Settings settings(Duration byte_time, Duration beacon) {
    return SoloNode::settings(byte_time, [beacon](Settings& s) {
      s.insertion_buffer = s.interrupt_buffer = s.send_queue = s.receive_buffers = 4;  // its state is small
      s.beacon = beacon;
    });
  }
  unsigned any(unsigned below) { return std::uniform_int_distribution<unsigned>(0, below - 1)(random_); }

  /// What ends a ring is rare: mostly the node is up.
  void give(unsigned what) {
    if (what < kDisruptive && any(10) != 0) return node_.run(now_);
    switch (what) {
      case 0:
        return node_.input_up(0_id, now_);
      case 1:
        return any(8) == 0 ? node_.input_lost(now_) : node_.input_gap(now_);
      case 2:
        return node_.output_up(2_id, now_);
      case 3:
        return any(2) == 0 ? node_.output_lost(now_) : node_.output_replaced(now_);
      case 4:
        return node_.set_folded(any(2) != 0, any(2) != 0, now_);
      case 5:
        return node_.set_output_ready(any(3) != 0);
      case 6:
        return node_.send(send_of(1, ++token_, NodeId(static_cast<std::uint8_t>(any(4))), data_), now_);
      case 7:
        return node_.interrupt({1, ++token_, 2_id, wire::Factor{1}}, now_);
      case 8:
        return node_.pull(1, ++token_, any(3), now_);
      case 9:
        return any(8) == 0 ? node_.cancel(1, now_) : node_.set_cpu_present(any(4) != 0);
      case 10:
        return any(8) == 0 ? node_.cpu_reset(1, now_) : set_cpu();
      case 11:
        return hear_beacon();
      case 12:
        return come_in();
      case 13:
        return come_home();
      case 14: {
        ReceivedPacket packet;
        node_.take(now_, packet);
        return;
      }
      case 15:
        return take_events();
      case 16:
        now_ = std::max(now_, std::min(node_.next_deadline(now_), now_ + 20ms));
        return any(2) != 0 ? node_.handle_timeout(now_) : node_.run(now_);
      case 17:
        return node_.handle_timeout(now_);
      default:
        return node_.run(now_);
    }
  }

  void take_events() {
    Event event;
    while (node_.take_event(now_, event)) {
    }
  }
  void set_cpu() {
    CpuReport report;
    report.boots = any(3);
    node_.set_cpu(report, now_);
  }
  void receive(const Bytes& packet) {
    node_.receive(Line::first, {wire::SliceKind::whole, {packet.data(), packet.size()}}, now_);
  }
  void come_in() {
    Foreign packet;
    packet.destination = any(2) != 0 ? 1 : 2;
    packet.sequence = ++sequence_;
    packet.pri = wire::pri_byte(wire::Priority{static_cast<std::uint8_t>(any(4))}, wire::id_of(wire::Channel::user));
    receive(packet.with(data_));
  }
  void hear_beacon() {
    Bytes bytes(wire::kBeaconSize);
    wire::Beacon beacon;
    beacon.boot = 3 + any(20) / 19;
    beacon.input = any(20) == 0 ? wire::LinkState::silent : wire::LinkState::up;
    beacon.break_known = beacon.input == wire::LinkState::silent;
    beacon.break_before = 2_id;
    beacon.break_behind = 3_id;
    wire::encode(beacon, bytes.data());
    receive(Foreign{3, wire::kBroadcast}.with_sequence(++sequence_).with_pri(kControlPri).with(bytes));
  }
  /// The last packet that was put onto the line, if it is the node's own, after a lap.
  void come_home() {
    const Bytes packet = std::exchange(last_packet_, {});
    if (packet.size() >= wire::kOverhead) receive(SoloNode::home(packet, wire::kFbcMax));
  }
  void keep(wire::ByteView line) {
    put_out_.insert(put_out_.end(), line.begin(), line.end());
    wire::each_slice(line, [this](const wire::Slice& slice) {
      if (slice.kind == wire::SliceKind::start || slice.kind == wire::SliceKind::whole) last_packet_.clear();
      if (slice.kind <= wire::SliceKind::whole)
        last_packet_.insert(last_packet_.end(), slice.bytes.begin(), slice.bytes.end());
    });
  }

  std::mt19937 random_;
  Blocks node_;
  Time now_{};
  std::uint32_t token_ = 0;
  std::uint8_t sequence_ = 0;
  Bytes put_out_, last_packet_;
  const Bytes data_ = pattern(64);
};

class KeptDeadline : public testing::TestWithParam<Duration> {};

TEST_P(KeptDeadline, IsTheOneThatALookAtEverythingFinds) {
  unsigned up = 0;
  for (unsigned seed = 1; seed <= kSeeds && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    AnyInputs keeps(seed, GetParam()), looks(seed, GetParam());
    ASSERT_TRUE(keeps.is_up());
    for (unsigned i = 0; i < kInputs && !HasFailure(); ++i) {
      looks.write_down();
      keeps.give_one();
      looks.give_one();
      EXPECT_TRUE(keeps.deadline() == looks.deadline()) << "after input " << i;
      EXPECT_EQ(keeps.put_out(), looks.put_out()) << "after input " << i;
      up += keeps.is_up();
    }
    EXPECT_TRUE(keeps.write_down() == looks.write_down()) << "their states differ";
  }
  EXPECT_GT(up, kSeeds * kInputs / 2) << "or little of what a node does is tried";
}

/// All but the last slice of a packet.
void come_in_up_to_end(SoloNode& solo, const Bytes& packet) {
  const Bytes head = head_of(packet);
  solo.receive(wire::SliceKind::start, {head.begin(), head.begin() + 4});
  solo.receive(wire::SliceKind::more, {head.begin() + 4, head.end()});
}

// The CPU is woken for the packet that comes behind the one that it takes.
TEST(KeptDeadlineOfTheCpu, IsThatOfTheNextPacketOnceOneIsTaken) {
  SoloNode solo{8ns};
  solo.join();
  const Bytes first = Foreign{}.with_sequence(1).with(pattern(64));
  const Bytes second = Foreign{}.with_sequence(2).with(pattern(64));
  come_in_up_to_end(solo, first);
  solo.receive(wire::SliceKind::end, tail_of(first));
  solo.run_for(1us);
  come_in_up_to_end(solo, second);
  solo.run_for(1us);
  solo.receive(wire::SliceKind::end, tail_of(second));
  EXPECT_GT(solo.node().next_deadline(solo.now()), solo.now() + 1us);
  EXPECT_EQ(solo.packets().size(), 1u);
  EXPECT_LT(solo.node().next_deadline(solo.now()), solo.now() + 1us);
}

INSTANTIATE_TEST_SUITE_P(LinesWithAndWithoutADataRate, KeptDeadline, testing::Values(Duration{0}, Duration{8ns}));

}  // namespace
}  // namespace limb_ring::core
