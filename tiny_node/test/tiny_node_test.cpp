// The node in C: against docs/test_vectors.json, in rings of its own kind under a virtual clock, and given arbitrary
// bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>

#include <cstdlib>
#include <deque>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "tiny_frame.h"
#include "tiny_node.h"

namespace {

using Bytes = std::vector<std::uint8_t>;
using nlohmann::json;
using testing::Each;
using testing::ElementsAre;
using testing::SizeIs;

const json& vectors() {
  static const json all = json::parse(std::ifstream(LIMB_RING_VECTORS));
  return all;
}

Bytes bytes_of(const std::string& digits) {
  Bytes out;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    out.push_back(static_cast<std::uint8_t>(std::stoul(digits.substr(i, 2), nullptr, 16)));
  return out;
}

std::uint64_t number_of(const json& digits) { return std::stoull(digits.get<std::string>(), nullptr, 16); }

TEST(TinyWire, HashesAreThoseOfTheTestVectors) {
  for (const json& one : vectors()["text_hashes"])
    EXPECT_EQ(tn_hash(TN_FNV, one["text"].get<std::string>().c_str()), number_of(one["fnv1a_64"])) << one;
}

TEST(TinyWire, CrcAndPatchRuleAreThoseOfTheTestVectors) {
  for (const json& one : vectors()["crc"]) {
    const Bytes bytes = bytes_of(one["bytes"]);
    EXPECT_EQ(tn_crc(bytes.data(), bytes.size()), number_of(one["crc"]));
  }
  for (const json& one : vectors()["change"])
    EXPECT_EQ(tn_change(static_cast<std::uint8_t>(number_of(one["delta"])), one["after"]), number_of(one["change"]));
  for (const json& one : vectors()["packets"]) {
    const Bytes packet = bytes_of(one["packet"]);
    const bool right = tn_crc(packet.data(), packet.size() - 4) == tn_get32(packet.data() + packet.size() - 4);
    EXPECT_EQ(right, one["name"].get<std::string>().find("damaged") == std::string::npos) << one;
  }
}

TEST(TinyWire, TheAgreementOfAPlainRingIsThatOfTheTestVectors) {
  const json& plain = vectors()["agreement"][0];
  tn_config config = {};
  config.times = tn_default_times;
  std::vector<std::string> names;
  for (const json& node : plain["ring_file"]["nodes"]) {
    names.push_back(node["name"]);
    config.order[config.count++] = node["id"];
  }
  std::vector<const char*> pointers;
  for (const std::string& name : names) pointers.push_back(name.c_str());
  tn_plain_agreement(&config, pointers.data());
  EXPECT_EQ(Bytes(config.agreement, config.agreement + TN_AGREEMENT), bytes_of(plain["behind_connect"]));
}

Bytes framed(std::uint16_t place, const Bytes& datagram) {
  Bytes line;
  tn_write_frame(
      place, datagram.data(), datagram.size(),
      [](void* out, std::uint8_t byte) { static_cast<Bytes*>(out)->push_back(byte); }, &line);
  return line;
}

TEST(TinyFrame, ADatagramOfEachSizeArrives) {
  std::mt19937 draw(1);
  tn_frame_reader reader = {};
  for (std::size_t size = 0; size <= TN_MOST_DATAGRAM; ++size) {
    Bytes datagram(size);
    for (std::uint8_t& byte : datagram)
      byte = static_cast<std::uint8_t>(size % 3 == 0 ? 0 : size % 3 == 1 ? 7 : draw());
    const Bytes line = framed(static_cast<std::uint16_t>(size), datagram);
    ASSERT_LE(line.size(), TN_MOST_FRAME);
    for (std::size_t i = 0; i + 1 < line.size(); ++i) ASSERT_FALSE(tn_read_frame(&reader, line[i])) << size;
    ASSERT_TRUE(tn_read_frame(&reader, line.back())) << size;
    EXPECT_EQ(reader.place, size);
    EXPECT_EQ(Bytes(reader.bytes + 2, reader.bytes + 2 + reader.size), datagram);
  }
  EXPECT_EQ(reader.damaged, 0u);
}

TEST(TinyFrame, ArbitraryBytesAreNotAFrameAndTheNextFrameIsFound) {
  std::mt19937 draw(2);
  tn_frame_reader reader = {};
  for (int i = 0; i < 1000; ++i) {
    for (unsigned n = draw() % 2000; n > 0; --n)
      ASSERT_FALSE(tn_read_frame(&reader, static_cast<std::uint8_t>(draw())));
    tn_read_frame(&reader, 0);
    bool whole = false;
    for (const std::uint8_t byte : framed(3, {1, 2, 3})) whole = tn_read_frame(&reader, byte);
    EXPECT_TRUE(whole);
  }
}

struct Taken {
  std::uint8_t source, priority, channel;
  Bytes data;
};

struct Net;

/// A node, what its CPU got, and how its sends ended.
struct TestNode {
  tn_node node;
  Net* net;
  std::vector<Taken> taken;
  std::vector<int> pins;
  std::vector<tn_outcome> ended;
  unsigned free = 32;
  bool running = true;
};

struct Datagram {
  std::uint8_t from;
  tn_address to;
  Bytes bytes;
};

/// Nodes 0, 1, ... on one clock; what one sends arrives within the same millisecond, unless `loses` says otherwise.
struct Net {
  std::uint32_t now = 0xFFFFFE00;  // the clock wraps within each test
  std::vector<std::unique_ptr<TestNode>> nodes;
  std::deque<Datagram> under_way;
  std::function<bool(const Datagram&)> loses = [](const Datagram&) { return false; };

  explicit Net(std::uint8_t count, std::uint8_t ours) {
    for (std::uint8_t i = 0; i < ours; ++i) {
      nodes.push_back(std::make_unique<TestNode>());
      nodes.back()->net = this;
      begin(i, count, 0x1880000000000001u + 16u * i);
    }
  }

  void begin(std::uint8_t id, std::uint8_t count, std::uint64_t boot) {
    static const char* const names[] = {"node0", "node1", "node2", "node3", "node4", "node5"};
    tn_config config = {};
    config.ring = "vectors";
    config.id = id;
    config.count = count;
    for (std::uint8_t i = 0; i < count; ++i) config.order[i] = i;
    config.times = tn_default_times;
    config.boot = boot;
    tn_plain_agreement(&config, names);
    TestNode* one = nodes[id].get();
    const tn_port port = {one, send, clock};
    const tn_cpu cpu = {one, free_buffers, take, pull, ended};
    tn_begin(&one->node, &config, &port, &cpu);
  }

  static bool send(void* context, tn_address to, const std::uint8_t* bytes, std::size_t size) {
    auto* one = static_cast<TestNode*>(context);
    one->net->under_way.push_back({one->node.config.id, to, Bytes(bytes, bytes + size)});
    return true;
  }
  static std::uint32_t clock(void* context) { return static_cast<TestNode*>(context)->net->now; }
  static unsigned free_buffers(void* context, std::uint8_t) { return static_cast<TestNode*>(context)->free; }
  static void take(void* context, std::uint8_t source, std::uint8_t priority, std::uint8_t channel,
                   const std::uint8_t* data, std::size_t size) {
    static_cast<TestNode*>(context)->taken.push_back({source, priority, channel, Bytes(data, data + size)});
  }
  static bool pull(void* context, std::uint8_t factor, std::uint8_t) {
    if (factor > 2) return false;
    static_cast<TestNode*>(context)->pins.push_back(factor);
    return true;
  }
  static void ended(void* context, unsigned, tn_outcome outcome) {
    static_cast<TestNode*>(context)->ended.push_back(outcome);
  }

  void deliver() {
    for (int most = 0; !under_way.empty() && most < 10000; ++most) {
      const Datagram one = under_way.front();
      under_way.pop_front();
      if (one.to < nodes.size() && nodes[one.to]->running && !loses(one))
        tn_came(&nodes[one.to]->node, one.from, one.bytes.data(), one.bytes.size());
    }
  }

  void run(std::uint32_t milliseconds) {
    for (; milliseconds > 0; --milliseconds) {
      ++now;
      for (const auto& one : nodes)
        if (one->running) tn_passed(&one->node);
      deliver();
    }
  }

  bool all(tn_state state, std::uint8_t size) const {
    for (const auto& one : nodes)
      if (one->running && (one->node.state != state || one->node.size != size)) return false;
    return true;
  }

  TestNode& operator[](std::size_t i) { return *nodes[i]; }
};

unsigned send_text(TestNode& from, std::uint8_t to, const std::string& text, std::uint8_t priority = 2) {
  return tn_send(&from.node, to, priority, 0, reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

TEST(TinyRing, JoinsAndEachReachesEach) {
  Net ring(4, 4);
  ring.run(500);
  ASSERT_TRUE(ring.all(TN_UP, 4));
  for (std::uint8_t to = 0; to < 4; ++to)
    for (std::uint8_t from = 0; from < 4; ++from) ASSERT_NE(send_text(ring[from], to, "to all of you"), 0u);
  ring.run(50);
  for (const auto& one : ring.nodes) {
    EXPECT_THAT(one->ended, testing::AllOf(SizeIs(4), Each(TN_DELIVERED)));
    EXPECT_THAT(one->taken, SizeIs(4));
  }
}

TEST(TinyRing, MoreSendsThanThereAreSequenceNumbersAllArrive) {
  Net ring(3, 3);
  ring.run(500);
  for (int i = 0; i < 40; ++i) {
    ASSERT_NE(send_text(ring[0], 2, std::to_string(i)), 0u);
    ASSERT_NE(send_text(ring[1], TN_ALL, std::to_string(i)), 0u);
    ring.run(3);
  }
  ASSERT_THAT(ring[2].taken, SizeIs(80));
  EXPECT_THAT(ring[0].ended, Each(TN_DELIVERED));
}

TEST(TinyRing, ANumberThatNobodyAnswersMakesANewHello) {
  Net ring(3, 2);  // node 2 is not there
  ring.run(1000);
  ASSERT_TRUE(ring.all(TN_UP, 2));
  const std::uint64_t boot = ring[0].node.boot;
  for (int i = 0; i < 8; ++i) {
    ASSERT_NE(send_text(ring[0], 2, "?"), 0u);
    ring.run(20);
  }
  EXPECT_THAT(ring[0].ended, testing::AllOf(SizeIs(8), Each(TN_NO_SUCH_NODE)));
  EXPECT_EQ(ring[0].node.boot, boot + 1);
}

TEST(TinyRing, PinsArePulledAndTheUnwiredOnesRefused) {
  Net ring(3, 3);
  ring.run(500);
  tn_pull(&ring[0].node, 1, 2);
  tn_pull(&ring[0].node, 1, 7);
  ring.run(5);
  EXPECT_THAT(ring[1].pins, ElementsAre(2));
  EXPECT_THAT(ring[0].ended, ElementsAre(TN_DELIVERED, TN_REFUSED));
}

TEST(TinyRing, AFullReceiverIsTriedAgainUntilItHasRoom) {
  Net ring(3, 3);
  ring.run(500);
  ring[1].free = 0;
  send_text(ring[0], 1, "knee");
  ring.run(200);
  EXPECT_TRUE(ring[0].ended.empty());
  EXPECT_GT(ring[0].node.counters.refusals, 5u);
  ring[1].free = 1;
  ring.run(70);
  EXPECT_THAT(ring[0].ended, ElementsAre(TN_DELIVERED));
  ring[1].free = 0;
  send_text(ring[0], 1, "knee");
  ring.run(1100);
  EXPECT_EQ(ring[0].ended.back(), TN_REFUSED);
}

TEST(TinyRing, WhatALineLosesIsRepeatedAndTakenOnce) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 draw(seed);
    Net ring(3, 3);
    ring.run(500);
    ring.loses = [&](const Datagram& one) { return one.bytes[3] == TN_SLICES && draw() % 10 == 0; };
    unsigned asked = 0;
    for (int i = 0; i < 40; ++i) {
      if (send_text(ring[0], 1, std::to_string(i)) != 0) ++asked;
      ring.run(150);
    }
    ring.run(2000);
    ASSERT_EQ(ring[0].ended.size(), asked);
    std::vector<Bytes> seen;
    for (const Taken& one : ring[1].taken) {
      EXPECT_EQ(std::count(seen.begin(), seen.end(), one.data), 0) << "taken twice";
      seen.push_back(one.data);
    }
    const auto confirmed = std::count(ring[0].ended.begin(), ring[0].ended.end(), TN_DELIVERED);
    EXPECT_GE(static_cast<long>(seen.size()), confirmed);
    EXPECT_GT(confirmed, 20);
  }
}

TEST(TinyRing, ADeadNodeIsBypassedAndTakenInAgain) {
  Net ring(4, 4);
  ring.run(500);
  ring[2].running = false;
  ring.run(1500);
  EXPECT_TRUE(ring.all(TN_UP, 3));
  ring[2].running = true;
  ring.begin(2, 4, 0x1880000000001000u);
  ring.run(2000);
  EXPECT_TRUE(ring.all(TN_UP, 4));
  send_text(ring[1], 2, "back");
  ring.run(5);
  EXPECT_THAT(ring[1].ended, ElementsAre(TN_DELIVERED));
}

TEST(TinyRing, ABrokenLineMakesAnOpenChainThatEndsWhenItIsMended) {
  Net ring(4, 4);
  ring.run(500);
  bool cut = true;
  ring.loses = [&](const Datagram& one) {
    return cut && one.from == 1 && one.bytes[3] != TN_ACCEPT && one.bytes[3] < TN_ALIVE;
  };
  ring.run(1500);
  EXPECT_EQ(ring[2].node.state, TN_OPEN_CHAIN);
  EXPECT_EQ(ring[3].node.state, TN_OPEN_CHAIN);
  EXPECT_EQ(ring[3].node.break_before, 1);
  send_text(ring[2], 3, "one way");
  ring.run(5);
  EXPECT_THAT(ring[2].ended, ElementsAre(TN_UNCONFIRMED));
  EXPECT_THAT(ring[3].taken, SizeIs(1));
  cut = false;
  ring.run(2500);
  EXPECT_TRUE(ring.all(TN_UP, 4));
  EXPECT_FALSE(ring[2].node.break_known);
}

/// Plays nodes 0 and 2 around node 1, which is ours.
class Between {
 public:
  explicit Between(bool returns) : net_(3, 2), returns_(returns) {
    net_[0].running = false;
    net_.nodes[0]->node.config.id = 0;
    for (int i = 0; i < 200; ++i) step();
  }

  TestNode& node() { return net_[1]; }

  /// @return the packets that the node has passed on
  std::vector<Bytes> give(std::uint8_t kind, const Bytes& content) {
    passed_.clear();
    slice(kind, content);
    read();
    return passed_;
  }

  void run_until(std::uint32_t instant) {
    while (instant_ < instant) step();
  }
  void begin_counting() { instant_ = 0; }

 private:
  void step() {
    ++instant_;
    ++net_.now;
    if (!asked_) connect();
    if (in_ && instant_ % 10 == 0) slice(TN_IDLE, {});
    if (out_ != 0 && instant_ % 10 == 0) header(2, TN_ALIVE, out_, 0, {});
    tn_passed(&node().node);
    read();
  }

  void header(std::uint8_t from, std::uint8_t type, std::uint64_t session, std::uint32_t sequence, const Bytes& more) {
    const tn_header fields = {3, type, from, 0, tn_hash(TN_FNV, "vectors"), session, sequence};
    Bytes bytes(TN_HEADER);
    tn_write_header(bytes.data(), &fields);
    bytes.insert(bytes.end(), more.begin(), more.end());
    tn_came(&node().node, from, bytes.data(), bytes.size());
  }

  void connect() {
    asked_ = true;
    const std::uint8_t* own = node().node.config.agreement;
    header(0, TN_CONNECT, 0x1111111100000000u, 0, Bytes(own, own + TN_AGREEMENT));
  }

  void slice(std::uint8_t kind, const Bytes& content) {
    Bytes bytes{0xA7, kind, static_cast<std::uint8_t>(content.size() >> 8), static_cast<std::uint8_t>(content.size())};
    bytes.insert(bytes.end(), content.begin(), content.end());
    header(0, TN_SLICES, in_, ++sequence_, bytes);
  }

  void read() {
    while (!net_.under_way.empty()) {
      const Datagram one = net_.under_way.front();
      net_.under_way.pop_front();
      tn_header fields;
      ASSERT_TRUE(tn_read_header(one.bytes.data(), one.bytes.size(), &fields));
      if (one.to == 2 && fields.type == TN_CONNECT) header(2, TN_ACCEPT, out_ = fields.session | 0x44444444u, 0, {});
      if (one.to == 0 && fields.type == TN_ACCEPT && in_ == 0) in_ = fields.session, slice(TN_IDLE, {});
      if (one.to == 2 && fields.type == TN_SLICES) on_slice(one.bytes);
    }
  }

  void on_slice(const Bytes& datagram) {
    Bytes packet(datagram.begin() + TN_HEADER + TN_SLICE, datagram.end());
    if (packet.size() < 12) return;
    if (packet[3] != 1) return passed_.push_back(packet);
    if (!returns_) return;
    tn_patch(packet.data(), packet.size(), 2, 254);
    slice(datagram[TN_HEADER + 1], packet);
  }

  Net net_;
  bool returns_, asked_ = false;
  std::uint64_t in_ = 0, out_ = 0;
  std::uint32_t sequence_ = 0, instant_ = 0;
  std::vector<Bytes> passed_;
};

void check(Between& between, const json& step) {
  TestNode& node = between.node();
  const std::size_t taken = node.taken.size(), pins = node.pins.size();
  Bytes packet = bytes_of(step["gets"]);
  const auto passed = between.give(packet.size() == 12 ? TN_INTERRUPT : TN_WHOLE, packet);
  tn_patch(packet.data(), packet.size(), 1, step["fbc"]);
  EXPECT_THAT(passed, ElementsAre(packet)) << step;
  EXPECT_EQ(node.taken.size() - taken, step["does"] == "takes" ? 1u : 0u) << step;
  EXPECT_EQ(node.pins.size() - pins, step["does"] == "pulls" ? 1u : 0u) << step;
}

TEST(TinyNode, TakesAPacketExactlyOnceAsTheTestVectorsSay) {
  for (const json& table : vectors()["exactly_once"]["tables"]) {
    Between between(table["joined"]);
    ASSERT_EQ(between.node().node.state, table["joined"] ? TN_UP : TN_JOINING);
    between.begin_counting();
    for (const json& step : table["steps"]) {
      between.run_until(step["at_ms"]);
      check(between, step);
    }
  }
}

TEST(TinyNode, PassesOnDamageAsDamage) {
  Between between(true);
  Bytes packet = bytes_of("42FB00006B6E656521FDFF02017E00FC51");
  packet[5] ^= 1;
  const auto passed = between.give(TN_WHOLE, packet);
  ASSERT_THAT(passed, SizeIs(1));
  EXPECT_NE(tn_crc(passed[0].data(), passed[0].size() - 4), tn_get32(passed[0].data() + passed[0].size() - 4));
  EXPECT_EQ(passed[0][passed[0].size() - 7], TN_UNTAKEN);
}

TEST(TinyNode, AnInterruptWithinAPacketGoesOnByItself) {
  Between between(true);
  const Bytes packet = bytes_of("42FB00006B6E656521FDFF0201"), interrupt = bytes_of("60FB0000FDFF0102EE31BB0B");
  Bytes whole = packet;
  whole.resize(whole.size() + 4);
  tn_put32(whole.data() + packet.size(), tn_crc(packet.data(), packet.size()));
  EXPECT_THAT(between.give(TN_START, Bytes(whole.begin(), whole.begin() + 8)), SizeIs(0));
  EXPECT_THAT(between.give(TN_INTERRUPT, interrupt), SizeIs(1));
  EXPECT_THAT(between.give(TN_END, Bytes(whole.begin() + 8, whole.end())), SizeIs(1));
  EXPECT_THAT(between.node().pins, ElementsAre(2));
}

/// Arbitrary datagrams, most of them nearly right: no sanitizer may complain, and the ring has to close again after
/// them.
TEST(TinyNode, SurvivesArbitraryDatagrams) {
  const char* more = std::getenv("LIMB_RING_SEEDS");
  for (unsigned seed = 1; seed <= (more != nullptr ? std::stoul(more) : 20u); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 draw(seed);
    Net ring(3, 3);
    ring.loses = [&](Datagram one) {
      if (draw() % 4 != 0 || ring.now > 4000000000u) return false;
      for (unsigned i = draw() % 4; i > 0; --i)
        one.bytes[draw() % one.bytes.size()] = static_cast<std::uint8_t>(draw());
      one.bytes.resize(draw() % 5 == 0 ? draw() % 560 : one.bytes.size());
      tn_came(&ring[draw() % 3].node, draw() % 3, one.bytes.data(), one.bytes.size());
      return draw() % 2 == 0;
    };
    for (int i = 0; i < 100; ++i) {
      send_text(ring[i % 3], static_cast<std::uint8_t>(draw() % 4), std::string(1 + draw() % 512, 'x'), draw() % 4);
      tn_pull(&ring[i % 3].node, static_cast<std::uint8_t>(draw() % 3), draw() % 8);
      ring.run(15);
    }
    ring.loses = [](const Datagram&) { return false; };
    ring.run(6000);
    EXPECT_TRUE(ring.all(TN_UP, 3));
  }
}

}  // namespace
