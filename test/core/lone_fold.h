#pragma once

#include "core/solo_node.h"
#include "wire/control_message.h"

namespace limb_ring::core {

/// A node of a ring of 8 with its four lines in the hands of the test.
struct LoneFold : testing::Test {
  explicit LoneFold(const Settings& s = settings()) : node(s, Time{}) {}
  NetworkController node;
  static Settings settings() {
    Settings s;
    s.id = 4_id;
    for (NodeId id{1}; id < 8; ++id) s.order.push_back(id);
    s.fold_back = true;
    s.wired.fill(true);
    return s;
  }
  void SetUp() override {
    node.apply(input::InputUp{Line::first, 3_id}, Time{});
    node.apply(input::OutputUp{Line::first, 5_id}, Time{});
    node.apply(input::InputUp{Line::second, 5_id}, Time{});
    node.apply(input::OutputUp{Line::second, 3_id}, Time{});
    second().clear();
  }
  wire::SliceWriter& second() { return node.output(Line::second); }
  void hear(wire::FoldWordKind kind, NodeId from, Time now = {}) {
    wire::SliceWriter word;
    wire::put(word, {kind, from});
    node.receive(Line::second, wire::parse_slice(word.view()).slice, now);
  }
  void receive_interrupt(Line line, std::uint8_t sequence, std::uint8_t hop) {
    test::InterruptPacket packet;
    packet.code.sequence = wire::Sequence{sequence};
    packet.hop = hop;
    packet.source = 1_id;
    packet.destination = wire::kBroadcast;
    const Bytes bytes = encoded(packet);
    node.receive(line, {wire::SliceKind::interrupt, {bytes.data(), bytes.size()}}, Time{});
  }
};

}  // namespace limb_ring::core
