#pragma once

#include "core/ring_fixture.h"
#include "support/node_literal.h"
#include "support/packets.h"

namespace limb_ring::core {

/// One network controller with id 1 in a ring of 4, both its lines in the hands of the test: what
/// comes from upstream is written by hand, what goes downstream is read back.
class SoloNode {
 public:
  struct Out {
    wire::SliceKind kind;
    Bytes bytes;
  };

  /// Of node 1 in a ring of 4 without beacons.
  static Settings settings(Duration byte_time, const std::function<void(Settings&)>& adjust) {
    Settings s;
    s.id = 1_id;
    s.order = {0_id, 1_id, 2_id, 3_id};
    s.boot = 100;
    s.byte_time_in = s.byte_time_out = byte_time;
    s.beacon = Duration{0};
    s.wired = {true, true, true};
    adjust(s);
    return s;
  }

  explicit SoloNode(
      Duration byte_time = Duration{0}, std::function<void(Settings&)> adjust = [](Settings&) {})
      : node_(settings(byte_time, adjust)) {
    node_.set_cpu_present(true);
    node_.input_up(0_id, now_);
    node_.output_up(2_id, now_);
  }

  ~SoloNode() { expect_counted_up(counters()); }

  Blocks& node() { return node_; }
  const Counters& counters() const { return node_.counters(); }
  Time now() const { return now_; }

  void receive(wire::SliceKind kind, const Bytes& bytes) {
    node_.receive(Line::first, {kind, {bytes.data(), bytes.size()}}, now_);
    run();
  }
  /// The same before the end of the event loop's turn: more may come in at this instant.
  void give(wire::SliceKind kind, const Bytes& bytes) {
    node_.receive(Line::first, {kind, {bytes.data(), bytes.size()}}, now_);
    collect();
  }
  void run() {
    node_.handle_timeout(now_);
    node_.run(now_);
    collect();
  }
  /// Time goes on; the node wakes whenever it asked for it.
  void run_for(Duration duration) {
    const Time until = now_ + duration;
    for (Time next = node_.next_deadline(now_); next <= until; next = node_.next_deadline(now_)) {
      now_ = std::max(now_, next);
      run();
    }
    now_ = until;
    run();
  }

  /// Slices put onto the line since the last call.
  std::vector<Out> line() { return std::exchange(line_, {}); }
  std::vector<wire::SliceKind> kinds() {
    std::vector<wire::SliceKind> out;
    for (const Out& slice : line()) out.push_back(slice.kind);
    return out;
  }
  std::vector<Bytes> packets() {
    std::vector<Bytes> out;
    ReceivedPacket packet;
    while (node_.take(now_, packet)) out.emplace_back(packet.bytes().begin(), packet.bytes().end());
    return out;
  }
  std::vector<SendEnded> ends() {
    std::vector<SendEnded> out;
    for (const Event& event : events_)
      if (const auto* end = std::get_if<SendEnded>(&event.what)) out.push_back(*end);
    return out;
  }
  const std::vector<Event>& events() const { return events_; }

  /// What the node has put out, as it comes back after a lap of 3 relays.
  static Bytes home(Bytes packet, std::uint8_t fbc, std::uint8_t hop = 3) {
    wire::rewrite(packet.data(), packet.size(), hop, fbc);
    return packet;
  }
  /// Lets the hello come home, so that the node is up.
  void join() {
    run_for(1us);
    const auto out = line();
    ASSERT_FALSE(out.empty());
    Bytes hello;
    for (const Out& slice : out) hello.insert(hello.end(), slice.bytes.begin(), slice.bytes.end());
    receive(wire::SliceKind::whole, home(hello, wire::kFbcMax));
    ASSERT_EQ(node_.membership().state(), NodeState::up);
  }
  /// Both its lines are lost, and come up again: it was bypassed, and starts over.
  void be_bypassed() {
    node_.input_lost(now_);
    node_.output_lost(now_);
    node_.input_up(0_id, now_);
    node_.output_up(2_id, now_);
    run();
    line();
  }

 private:
  void collect() {
    wire::ByteView rest = node_.line().view();
    while (!rest.empty()) {
      const wire::SliceParse parse = wire::parse_slice(rest);
      line_.push_back({parse.slice.kind, Bytes(parse.slice.bytes.begin(), parse.slice.bytes.end())});
      rest = rest.from(parse.consumed);
    }
    node_.line().clear();
    Event event;
    while (node_.take_event(now_, event)) events_.push_back(event);
  }

  Blocks node_;
  Time now_{};
  std::vector<Out> line_;
  std::vector<Event> events_;
};

/// The last field of hellos and beacons.
const std::uint8_t kControlPri = wire::pri_byte(wire::Priority{0}, wire::id_of(wire::Channel::control));

/// A DATP as another node has sent it.
struct Foreign {
  std::uint8_t source = 0, destination = 1;
  std::uint8_t sequence = 0, attempt = 0, hop = 0, pri = 0, fbc = wire::kFbcUntaken;
  wire::Incarnation incarnation{};

  Foreign with_sequence(std::uint8_t value) const { return changed(&Foreign::sequence, value); }
  Foreign with_attempt(std::uint8_t value) const { return changed(&Foreign::attempt, value); }
  Foreign with_hop(std::uint8_t value) const { return changed(&Foreign::hop, value); }
  Foreign with_pri(std::uint8_t value) const { return changed(&Foreign::pri, value); }
  Foreign changed(std::uint8_t Foreign::*field, std::uint8_t value) const {
    Foreign copy = *this;
    copy.*field = value;
    return copy;
  }

  Bytes with(const Bytes& data) const {
    test::DataPacket packet;
    packet.code = {false, attempt, wire::Sequence{sequence}, incarnation};
    packet.hop = hop;
    packet.source = NodeId{source};
    packet.fbc = fbc;
    packet.destination = NodeId{destination};
    packet.pri = pri;
    packet.data = {data.data(), data.size()};
    return encoded(packet);
  }
};

inline Bytes foreign_interrupt(std::uint8_t source, std::uint8_t destination, std::uint8_t factor,
                               std::uint8_t sequence = 0, std::uint8_t attempt = 0,
                               wire::Incarnation incarnation = {}) {
  test::InterruptPacket packet;
  packet.code = {true, attempt, wire::Sequence{sequence}, incarnation};
  packet.source = NodeId{source};
  packet.destination = NodeId{destination};
  packet.factor = wire::Factor{factor};
  return encoded(packet);
}

/// The header and all whole words of the payload; the rest, trailer and CRC.
inline Bytes head_of(const Bytes& packet) {
  return {packet.begin(), packet.begin() + static_cast<long>((packet.size() - 8) / 4 * 4)};
}
inline Bytes tail_of(const Bytes& packet) {
  return {packet.begin() + static_cast<long>((packet.size() - 8) / 4 * 4), packet.end()};
}

/// Node 3 says that the line from node 2 into it is broken.
inline void hear_of_break(SoloNode& solo) {
  wire::Beacon beacon;
  beacon.input = wire::LinkState::silent;
  beacon.break_known = true;
  beacon.break_before = 2_id;
  beacon.break_behind = 3_id;
  Bytes bytes(wire::kBeaconSize);
  wire::encode(beacon, bytes.data());
  solo.receive(wire::SliceKind::whole, Foreign{3, wire::kBroadcast}.with_hop(1).with_pri(kControlPri).with(bytes));
}

}  // namespace limb_ring::core
