#include "client/inbox.h"

#include <gtest/gtest.h>

namespace limb_ring::client {
namespace {

Packet packet(std::uint8_t priority, std::uint8_t mark) { return {1, 2, priority, 0, {mark}}; }

Result result(std::uint32_t token) {
  Result made;
  made.token = token;
  return made;
}

/// "p7" packet with mark 7, "i1" interrupt of factor 1, "r5" result of token 5, and so on.
std::string name(const Message& message) {
  struct Namer {
    std::string operator()(const Packet& p) { return "p" + std::to_string(p.data.at(0)); }
    std::string operator()(const Interrupt& i) { return "i" + std::to_string(i.factor); }
    std::string operator()(const Result& r) { return "r" + std::to_string(r.token); }
    std::string operator()(const Reply& r) { return "a" + std::to_string(r.token); }
    std::string operator()(const Observed& o) { return "o" + o.json; }
    std::string operator()(const ObservedLost& l) { return "lost" + std::to_string(l.count); }
    std::string operator()(const CapturedPacket& c) {
      return "c" + std::to_string(c.bytes.at(0)) + "-" + std::to_string(c.lost_before);
    }
    std::string operator()(const CaptureCounts& c) { return "counts" + std::to_string(c.seen); }
    std::string operator()(const Disconnected&) { return "end"; }
  };
  return std::visit(Namer{}, message);
}

std::string drain(Inbox& inbox) {
  std::string names;
  while (const auto message = inbox.take()) names += (names.empty() ? "" : " ") + name(*message);
  return names;
}

TEST(Inbox, IsFullIfADaemonSendsMorePacketsThanItWasAskedFor) {
  Inbox inbox;
  for (int i = 0; i < 65536 && !inbox.full(); ++i) inbox.put(packet(0, 1));
  EXPECT_TRUE(inbox.full());
}

TEST(Inbox, HandsOutPacketsByPriority) {
  Inbox inbox;
  inbox.put(packet(3, 1));
  inbox.put(packet(1, 2));
  inbox.put(packet(0, 3));
  inbox.put(packet(1, 4));
  EXPECT_EQ(drain(inbox), "p3 p2 p4 p1");
  EXPECT_TRUE(inbox.empty());
}

TEST(Inbox, HandsOutInterruptsBeforeAllElse) {
  Inbox inbox;
  inbox.put(result(1));
  inbox.put(packet(0, 1));
  inbox.put(Interrupt{Interrupt::Action::stop, 0, 1});
  EXPECT_EQ(drain(inbox), "i1 r1 p1");
}

TEST(Inbox, DoesNotLetAStreamOfPacketsDelayAResult) {
  Inbox inbox;
  inbox.put(packet(3, 1));
  inbox.put(result(1));
  inbox.put(packet(0, 2));
  inbox.put(packet(0, 3));
  EXPECT_EQ(drain(inbox), "p2 r1 p3 p1");
}

TEST(Inbox, FindsResultsAndRepliesByToken) {
  Inbox inbox;
  inbox.put(result(1));
  inbox.put(Reply{2, "two"});
  inbox.put(result(3));
  EXPECT_FALSE(inbox.take_result(2));
  EXPECT_EQ(inbox.take_reply(2)->json, "two");
  EXPECT_EQ(inbox.take_result(3)->token, 3u);
  EXPECT_EQ(drain(inbox), "r1");
}

TEST(Inbox, CountsTheObservationsThatDoNotFit) {
  Inbox inbox;
  for (int i = 0; i < 4096 + 5; ++i) inbox.put(Observed{"x"});
  for (int i = 0; i < 4095; ++i) ASSERT_EQ(name(*inbox.take()), "ox");
  inbox.put(Observed{"y"});
  EXPECT_EQ(drain(inbox), "ox lost5 oy");
}

TEST(Inbox, ReportsLostObservationsEvenIfNoneFollows) {
  Inbox inbox;
  for (int i = 0; i < 4096 + 5; ++i) inbox.put(Observed{"x"});
  for (int i = 0; i < 4096; ++i) ASSERT_EQ(name(*inbox.take()), "ox");
  EXPECT_EQ(drain(inbox), "lost5");
}

TEST(Inbox, IsFullWhenResultsAreNotFetched) {
  Inbox inbox;
  for (std::uint32_t token = 0; token < 65535; ++token) inbox.put(result(token));
  EXPECT_FALSE(inbox.full());
  inbox.put(result(65535));
  EXPECT_TRUE(inbox.full());
}

TEST(Inbox, SaysHowManyCapturedPacketsItCouldNotHold) {
  Inbox inbox;
  CapturedPacket packet;
  packet.bytes = {7};
  for (int i = 0; i < 4096 + 5; ++i) inbox.put(packet);
  packet.lost_before = 2;  // by the daemon
  inbox.put(packet);
  for (int i = 0; i < 4096; ++i) EXPECT_EQ(name(*inbox.take()), "c7-0");
  EXPECT_FALSE(inbox.take());
  inbox.put(packet);
  EXPECT_EQ(name(*inbox.take()), "c7-10");
}

}  // namespace
}  // namespace limb_ring::client
