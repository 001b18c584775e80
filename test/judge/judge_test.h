#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "judge/promise_judge.h"
#include "wire/packet.h"

namespace limb_ring::promises {

using wire::Outcome;
using Kind = Observation::Kind;

constexpr std::uint8_t kAll = wire::kBroadcast;
constexpr std::uint8_t kStateUp = 2, kStarting = 0;

/// The judge of the ring's promises, told what was seen at three nodes.
struct JudgeTest : testing::Test {
  JudgeTest() {
    for (const std::uint8_t id : {1, 2, 3}) begins(id);
    rounds(40);  // so long that nothing can be under way that was not seen
    deliver(1, 2, 900);
    deliver(2, 3, 901);
    interrupt(1, 3, 902, 0);
    pin(3, 1, 0);
    end_interrupt(1, 3, 902, Outcome::delivered);
    rounds(40);
  }

  void begins(std::uint8_t id) { judge.begins(id, kStateUp, std::chrono::seconds(5), now); }
  /// All nodes go on, and their receive buffers are empty but for those of `full`.
  void rounds(int count, int full = -1) {
    for (int i = 0; i < count; ++i) {
      now += 50'000'000;
      for (const std::uint8_t id : {1, 2, 3}) {
        if (id == silent) continue;
        Observation seen = of(Kind::goes_on);
        seen.detail = id == full ? 0 : 1;
        judge.see(id, seen);
      }
      judge.round_is_over();
    }
  }
  Observation of(Kind kind) {
    Observation seen;
    seen.kind = kind;
    seen.at_ns = now += 1000;
    return seen;
  }
  Observation packet(Kind kind, std::uint8_t to, std::uint32_t content) {
    Observation seen = of(kind);
    seen.destination = to;
    seen.checksum = content;
    seen.size = 8;
    seen.queue = 2;
    return seen;
  }
  void ask(std::uint8_t from, std::uint8_t to, std::uint32_t token, std::uint32_t content = 0) {
    Observation seen = packet(Kind::asked, to, content == 0 ? token : content);
    seen.token = token;
    judge.see(from, seen);
  }
  void end(std::uint8_t from, std::uint8_t to, std::uint32_t token, Outcome outcome, std::uint8_t tries = 1) {
    Observation seen = of(Kind::ended);
    seen.destination = to;
    seen.token = token;
    seen.detail = static_cast<std::uint8_t>(outcome);
    seen.tries = tries;
    judge.see(from, seen);
  }
  void take(std::uint8_t at, std::uint8_t from, std::uint32_t content, std::uint8_t to = 0, Kind kind = Kind::taken) {
    Observation seen = packet(kind, to == 0 ? at : to, content);
    seen.source = from;
    judge.see(at, seen);
  }
  void deliver(std::uint8_t from, std::uint8_t to, std::uint32_t token) {
    ask(from, to, token);
    take(to, from, token);
    end(from, to, token, Outcome::delivered);
  }
  /// The same, with data that many have.
  void deliver_equal(std::uint8_t from, std::uint8_t to, std::uint32_t token) {
    ask(from, to, token, 77);
    take(to, from, 77);
    end(from, to, token, Outcome::delivered);
  }
  void interrupt(std::uint8_t from, std::uint8_t to, std::uint32_t token, std::uint8_t factor) {
    Observation seen = of(Kind::asked);
    seen.destination = to;
    seen.token = token;
    seen.queue = Observation::kInterrupt;
    seen.channel = factor;
    judge.see(from, seen);
  }
  void end_interrupt(std::uint8_t from, std::uint8_t to, std::uint32_t token, Outcome outcome) {
    Observation seen = of(Kind::ended);
    seen.destination = to;
    seen.token = token;
    seen.queue = Observation::kInterrupt;
    seen.detail = static_cast<std::uint8_t>(outcome);
    seen.tries = 1;
    judge.see(from, seen);
  }
  void pin(std::uint8_t at, std::uint8_t from, std::uint8_t factor) {
    Observation seen = of(Kind::pin);
    seen.source = from;
    seen.destination = at;
    seen.queue = Observation::kInterrupt;
    seen.channel = factor;
    judge.see(at, seen);
  }
  /// Of two equal interrupts of node 1 to 3 the first, 14, is lost, and a pin is pulled when the second, 15, is out.
  void pull_for_the_second_of_two() {
    interrupt(1, 3, 14, 0);
    end_interrupt(1, 3, 14, Outcome::lost);
    interrupt(1, 3, 15, 0);
    pin(3, 1, 0);
  }
  void state(std::uint8_t at, std::uint8_t after) {
    Observation seen = of(Kind::state);
    seen.detail = after;
    judge.see(at, seen);
  }
  std::vector<Promise> broken() const {
    std::vector<Promise> promises;
    for (const Breach& breach : breaches) promises.push_back(breach.promise);
    return promises;
  }
  std::uint64_t unjudged(Unjudged why) const { return judge.counts().unjudged[static_cast<std::size_t>(why)]; }

  std::int64_t now = 1'000'000'000;
  int silent = -1;
  std::vector<Breach> breaches;
  PromiseJudge judge{false, [this](const Breach& breach) { breaches.push_back(breach); }};
};

}  // namespace limb_ring::promises
