#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sim/invariants.h"

namespace limb_ring::core {

using sim::VirtualRingOptions;
using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

/// Counters only count up. One that was counted down from 0 is above anything that happens in a test.
inline void expect_counted_up(const Counters& counters) {
  counters.each([](const char* name, const char*, std::uint64_t value) { EXPECT_LT(value, 1ull << 32) << name; });
}

/// A ring that is watched: whatever a test is about, no promise of the ring may be broken in it.
class VirtualRing : public sim::VirtualRing {
 public:
  explicit VirtualRing(const VirtualRingOptions& options) : sim::VirtualRing(options) {}
  ~VirtualRing() {
    if (const auto& broken = invariants_.violation())
      ADD_FAILURE() << "promise broken: " << sim::to_string(broken->promise) << "\n"
                    << broken->what() << "\nat " << core::picoseconds(broken->at.time_since_epoch()) << " ps";
    for (const NodeId id : order())
      if (alive(id)) expect_counted_up(counters(id));
  }

 private:
  sim::Invariants invariants_{*this};
};

inline Bytes text(const std::string& s) { return {s.begin(), s.end()}; }
/// What a CPU or tool asks for. @param data must outlive the request
inline SendRequest send_of(Owner owner, std::uint32_t token, NodeId to, const Bytes& data) {
  SendRequest request;
  request.owner = owner;
  request.token = token;
  request.destination = to;
  request.data = {data.data(), data.size()};
  return request;
}

/// Payload whose every byte differs from its neighbours.
inline Bytes pattern(std::size_t size, unsigned start = 0) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(start + i);
  return bytes;
}

/// The ring of protocol.md section 7.2: 1 Gbit/s, d = 512 ns; joined, beacons off.
inline VirtualRingOptions gigabit(unsigned nodes) {
  VirtualRingOptions options;
  options.nodes = nodes;
  options.byte_time = 8ns;
  options.relay_delay = 512ns;
  options.adjust = [](Settings& settings) {
    settings.beacon = Duration{0};
    settings.send_timeout_least = Duration{0};
  };
  return options;
}

/// A ring without data rate and beacons: what is sent arrives one relay delay later.
inline VirtualRingOptions quick(unsigned nodes) {
  VirtualRingOptions options;
  options.nodes = nodes;
  options.relay_delay = 1us;
  options.adjust = [](Settings& settings) { settings.beacon = Duration{0}; };
  return options;
}

inline std::vector<Bytes> payloads(const sim::NodeLog& log) {
  std::vector<Bytes> out;
  for (const ReceivedPacket& p : log.packets) out.emplace_back(p.bytes().begin(), p.bytes().end());
  return out;
}

inline std::vector<unsigned> pins(const sim::NodeLog& log) {
  std::vector<unsigned> out;
  for (const Event& e : log.events)
    if (const auto* pin = std::get_if<PinPulled>(&e.what)) out.push_back(pin->factor);
  return out;
}

/// The same with further changes to every node's settings.
template <class Adjust>
VirtualRingOptions with(VirtualRingOptions options, Adjust adjust) {
  options.adjust = [before = options.adjust, adjust](Settings& settings) {
    before(settings);
    adjust(settings);
  };
  return options;
}

/// A tap that loses the next slices for which `which` is true, `count` of them.
template <class Which>
VirtualRing::Tap lose(int count, Which which) {
  return [=](const wire::Slice& slice, Time, wire::SliceWriter& arriving) mutable {
    if (which(slice) && count-- > 0) return;
    arriving.put(slice.kind, slice.bytes);
  };
}

/// A tap that turns a bit of byte `at` in the next slices for which `which` is true.
template <class Which>
VirtualRing::Tap damage(int count, std::size_t at, Which which) {
  return [=](const wire::Slice& slice, Time, wire::SliceWriter& arriving) mutable {
    std::uint8_t* bytes = arriving.put_space(slice.kind, slice.bytes.size);
    std::copy(slice.bytes.begin(), slice.bytes.end(), bytes);
    if (which(slice) && count-- > 0) bytes[at] ^= 0x10;
  };
}

inline bool is_data(const wire::Slice& slice) { return slice.kind == wire::SliceKind::whole; }
inline bool is_interrupt(const wire::Slice& slice) { return slice.kind == wire::SliceKind::interrupt; }

/// The ends of all sends of a node, in the order in which they ended.
inline std::vector<std::uint32_t> ended_tokens(const sim::NodeLog& log) {
  std::vector<std::uint32_t> out;
  for (const Event& e : log.events)
    if (const auto* end = std::get_if<SendEnded>(&e.what)) out.push_back(end->token);
  return out;
}

/// Waits in virtual time for the end of a send; fails the test where it does not come.
inline SendEnded outcome_of(sim::VirtualRing& ring, NodeId node, std::uint32_t token, Duration limit = 10s) {
  const bool came = ring.run_until([&] { return ring.ended(node, token) != nullptr; }, limit);
  EXPECT_TRUE(came) << "send " << token << " of node " << int{node} << " never ended";
  return came ? *ring.ended(node, token) : SendEnded{};
}

}  // namespace limb_ring::core
