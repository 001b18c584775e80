#include "study/measure/timeline.h"

#include <map>
#include <stdexcept>
#include <utility>

#include "judge/forwarding_checker.h"
#include "sim/watched_ring.h"
#include "study/analysis/model_ring.h"
#include "study/analysis/ring_bounds.h"

namespace limb_ring::study {

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
