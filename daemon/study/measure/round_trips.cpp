#include "study/measure/round_trips.h"

#include <stdexcept>

#include "sim/watched_ring.h"
#include "study/analysis/model_ring.h"
#include "study/analysis/ring_bounds.h"
#include "study/comparison/offered_load.h"
#include "study/comparison/ring_feed.h"

namespace limb_ring::study {

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

}  // namespace limb_ring::study
