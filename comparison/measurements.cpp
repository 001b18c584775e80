#include "comparison/measurements.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "comparison/network.h"
#include "comparison/ring_network.h"
#include "judge/forwarding_checker.h"
#include "sim/invariants.h"
#include "study/model_ring.h"

namespace limb_ring::study {
namespace {

std::int64_t bin_of(Duration value, Duration width) { return (value - Duration{1}) / width; }

}  // namespace

std::vector<Bin> histogram(const std::vector<Duration>& values, Duration width) {
  if (values.empty()) return {};
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  const std::int64_t first = bin_of(*least, width), last = bin_of(*greatest, width);
  std::vector<Bin> bins;
  for (std::int64_t i = first; i <= last; ++i) bins.push_back({i * width, (i + 1) * width, 0});
  for (const Duration value : values) ++bins[static_cast<std::size_t>(bin_of(value, width) - first)].count;
  return bins;
}

// ---- of DATPs -------------------------------------------------------------------------------

namespace {

/// How many packets make a distribution: a second or two of work for any number of nodes.
std::int64_t packet_count(const Medium& medium) {
  constexpr std::int64_t kPacketHops = 1'600'000;
  return kPacketHops / medium.nodes;
}

/// Notes how sends end. An observer, since the feed has taken the ring's callbacks.
struct Ends : sim::Observer {
  Latencies round_trips;
  void event(NodeId, const core::Event& event) override {
    const auto* end = std::get_if<core::SendEnded>(&event.what);
    if (end && end->owner != core::kController) round_trips.add(end->round_trip);
  }
};

}  // namespace

Latencies data_round_trips(const Medium& medium, double load, std::uint64_t seed) {
  Random random(seed);
  const Duration span = packet_count(medium) * packet_time(medium);
  const std::vector<Message> messages = random_load(medium, load, Time{}, span, random);
  Ends ends;
  sim::WatchedRing ring(ring_options(medium));
  join_and_settle(ring, medium);
  ring.add_observer(ends);
  RingFeed feed(ring, messages);
  const auto all_back = [&] { return ends.round_trips.count() == messages.size(); };
  ring.run_until(all_back, core::kNever - ring.now());
  ring.check();
  return ends.round_trips;
}

// ---- of INTPs -------------------------------------------------------------------------------

namespace {

constexpr std::uint8_t kFactor = 1;

/// Every node sends a DATP as soon as its last is back, and asks for an INTP a random while after its
/// last is back.
class FullLoad {
 public:
  FullLoad(sim::VirtualRing& ring, const Medium& medium, std::uint64_t seed)
      : ring_(ring), medium_(medium), random_(seed), data_(medium.payload), asked_(medium.nodes) {
    ring.on_event = [this](NodeId node, const core::Event& event) {
      const auto* end = std::get_if<core::SendEnded>(&event.what);
      if (end && end->owner != core::kController) ended(node, *end, event.at);
    };
    for (unsigned id = 0; id < medium.nodes; ++id) {
      ring.at(ring.now() + pause(), [this, id] { send(static_cast<NodeId>(id)); });
      interrupt_later(static_cast<NodeId>(id));
    }
  }
  FullLoad(const FullLoad&) = delete;
  FullLoad& operator=(const FullLoad&) = delete;

  Latencies round_trips;

 private:
  void ended(NodeId node, const core::SendEnded& end, Time at) {
    if (end.outcome != core::Outcome::delivered) throw std::runtime_error("a send under full load was not delivered");
    if (!end.interrupt) return send(node);
    round_trips.add(at - asked_[node]);
    interrupt_later(node);
  }
  /// Up to a worst lap: whatever rhythm the DATPs fall into, every phase of it is met.
  Duration pause() {
    const Duration lap = data_bound(medium_, medium_.nodes);
    return Duration{static_cast<std::int64_t>(draw(random_, static_cast<std::uint64_t>(lap.count())))};
  }
  NodeId other(NodeId node) {
    return static_cast<NodeId>((node + 1 + draw(random_, medium_.nodes - 1)) % medium_.nodes);
  }
  void send(NodeId node) { ring_.send(node, other(node), data_); }
  void interrupt_later(NodeId node) {
    ring_.at(ring_.now() + pause(), [this, node] {
      asked_[node] = ring_.now();
      ring_.interrupt(node, other(node), kFactor);
    });
  }

  sim::VirtualRing& ring_;
  const Medium& medium_;
  Random random_;
  const std::vector<std::uint8_t> data_;
  std::vector<Time> asked_;
};

}  // namespace

Latencies interrupt_round_trips(const Medium& medium, bool embed, std::uint64_t seed) {
  sim::VirtualRingOptions options = ring_options(medium);
  options.keep_logs = false;
  options.adjust = [adjust = options.adjust, embed](core::Settings& settings) {
    adjust(settings);
    settings.embed_interrupts = embed;
  };
  sim::VirtualRing ring(options);
  join_and_settle(ring, medium);
  FullLoad load(ring, medium, seed);
  const auto count = static_cast<std::size_t>(packet_count(medium));
  ring.run_until([&load, count] { return load.round_trips.count() >= count; }, core::kNever - ring.now());
  return load.round_trips;
}

namespace {

/// Notes when the DATPs of a lap pass. A slice is given out as its header, or its last odd bytes,
/// trailer and CRC, begin. (core/packet_manager/packet_manager.h)
class Recorder : public sim::Observer {
 public:
  explicit Recorder(const Medium& medium) : medium_(medium), coming_(medium.nodes), going_(medium.nodes) {}

  void arrives(NodeId node, const wire::Slice& slice, Time now) override {
    note(coming_[node], node, slice, now, &Passing::arrives);
  }
  void leaves(NodeId node, const wire::Slice& slice, Time now) override {
    note(going_[node], node, slice, now, &Passing::leaves);
  }

  Time start{};                             ///< what all times count from
  using Key = std::pair<NodeId, unsigned>;  ///< source, hop
  std::map<Key, Passing> passings;

 private:
  /// The packet that is passing one end of a line.
  struct Place {
    Passing* passing = nullptr;
    std::size_t size = 0;
  };

  /// HOP was one less on the line it came from.
  Key key_of(NodeId node, const sim::PacketHeader& head, bool arriving) const {
    const unsigned hops = (node + medium_.nodes - head.source) % medium_.nodes;
    return {head.source, arriving && hops == 0 ? medium_.nodes : hops};
  }
  void note(Place& place, NodeId node, const wire::Slice& slice, Time now,
            std::optional<Passing::Span> Passing::*span) {
    if (slice.kind == wire::SliceKind::start) {
      const Key key = key_of(node, sim::PacketHeader::of(slice.bytes), span == &Passing::arrives);
      place = {&passings[key], 0};
      place.passing->source = key.first;
      place.passing->hop = key.second;
      place.passing->*span = Passing::Span{now - start, {}};
    }
    place.size += slice.bytes.size;
    if (slice.kind != wire::SliceKind::end) return;
    const auto rest = static_cast<std::int64_t>(wire::tail_size(place.size));
    (place.passing->*span)->tail = now - start + medium_.byte_time() * rest;
  }

  const Medium& medium_;
  std::vector<Place> coming_, going_;
};

Timeline timeline_of(const Recorder& recorder, const Medium& medium) {
  Timeline out;
  for (const auto& [key, passing] : recorder.passings)
    if (key.first == 0) out.ours.push_back(passing);
  if (out.ours.size() != medium.nodes + 1) throw std::runtime_error("the packet did not go round");
  for (const auto& [key, passing] : recorder.passings) {
    if (key.first == 0 || !passing.leaves) continue;
    const Passing& ours = out.ours[passing.node(medium)];
    if (passing.leaves->header < ours.leaves->header) out.in_front.push_back(passing);
  }
  return out;
}

Timeline record(const Medium& medium, bool others_send) {
  Recorder recorder(medium);
  sim::WatchedRing ring(ring_options(medium));
  join_and_settle(ring, medium);
  const Time start = recorder.start = ring.now();
  ring.add_observer(recorder);
  const auto send = [&](unsigned id) {
    ring.send(static_cast<NodeId>(id), static_cast<NodeId>((id + 1) % medium.nodes),
              std::vector<std::uint8_t>(medium.payload));
  };
  send(0);
  for (unsigned id = 1; others_send && id < medium.nodes; ++id)
    ring.at(start + id * medium.relay_delay + (id - 1) * packet_time(medium), [send, id] { send(id); });
  ring.run_until(start + data_bound(medium, medium.nodes));
  ring.check();
  return timeline_of(recorder, medium);
}

}  // namespace

Timeline timeline_alone(const Medium& medium) { return record(medium, false); }
Timeline timeline_worst(const Medium& medium) { return record(medium, true); }

}  // namespace limb_ring::study
