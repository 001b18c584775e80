#include "wire/traced_ring.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "wire/packet_trace.h"

namespace limb_ring::capture {
namespace {

using Key = std::pair<wire::NodeId, std::uint8_t>;  // source, Code

/// Tries of one Code that may still go on.
struct Open {
  std::size_t trip;
  std::size_t last;   ///< sighting
  std::size_t begun;  ///< packets of that source and kind up to this one
};

/// More are under way only of a line that doubles without end: the oldest is given up then.
constexpr std::size_t kMostOpen = 8;
constexpr std::size_t kOtherNumbers = 7;  // between two packets of one number to one destination
constexpr std::chrono::seconds kLongWay{1};

class Sorter {
 public:
  explicit Sorter(const std::vector<SeenPacket>& packets) : packets_(packets) {}

  std::vector<Trip> sorted() {
    for (std::size_t i = 0; i < packets_.size(); ++i) add(i);
    return std::move(trips_);
  }

 private:
  void add(std::size_t i) {
    std::vector<Open>& of_code = open_[{packets_[i].source, packets_[i].code}];
    if (Open* found = nearest(of_code, packets_[i])) {
      trips_[found->trip].seen.push_back(i);
      found->last = i;
      return;
    }
    if (of_code.size() == kMostOpen) of_code.erase(of_code.begin());
    of_code.push_back({trips_.size(), i, ++begun(packets_[i])});
    trips_.push_back({{i}});
  }

  /// The one that was seen nearest before it, the youngest of several; none if it is the first.
  Open* nearest(std::vector<Open>& of_code, const SeenPacket& packet) {
    Open* best = nullptr;
    for (Open& one : of_code)
      if (goes_on(one, packet) && (best == nullptr || packets_[one.last].stage() >= packets_[best->last].stage()))
        best = &one;
    return best;
  }

  bool goes_on(const Open& one, const SeenPacket& packet) {
    const SeenPacket& last = packets_[one.last];
    if (last.stage() >= packet.stage() || !packet.may_be(last)) return false;
    const std::size_t since = begun(packet) - one.begun;
    return since == 0 || (since < kOtherNumbers && packet.began - last.began <= kLongWay);
  }

  std::size_t& begun(const SeenPacket& packet) { return begun_[packet.source][packet.interrupt() ? 1 : 0]; }

  const std::vector<SeenPacket>& packets_;
  std::vector<Trip> trips_;
  std::map<Key, std::vector<Open>> open_;
  std::array<std::array<std::size_t, 2>, 256> begun_{};
};

}  // namespace

std::vector<Trip> sort_into_trips(const std::vector<SeenPacket>& packets) { return Sorter(packets).sorted(); }

namespace {

std::vector<SeenPacket> in_order(std::vector<SeenPacket> packets) {
  std::stable_sort(packets.begin(), packets.end(), [](const SeenPacket& a, const SeenPacket& b) {
    return std::make_pair(a.began, a.stage()) < std::make_pair(b.began, b.stage());
  });
  return packets;
}

}  // namespace

TracedRing::TracedRing(std::vector<SeenPacket> packets)
    : packets_(in_order(std::move(packets))), trips_(sort_into_trips(packets_)) {
  for (const SeenPacket& packet : packets_)
    if (!packet.info.input) outputs_[wire::NodeId{packet.info.from}].add(packet);
  EarlierTries tries;
  for (std::size_t trip = 0; trip < trips_.size(); ++trip)
    before_.push_back(tries.before({clearest(trip), first(trip).began, last(trip).last, end_of(trip)}));
}

// The first one that is whole and good, else whole, else any.
const SeenPacket& TracedRing::clearest(std::size_t trip) const {
  const SeenPacket* whole = nullptr;
  for (const std::size_t seen : trips_[trip].seen) {
    const SeenPacket& packet = packets_[seen];
    if (packet.trailer && !packet.info.crc_bad) return packet;
    if (packet.trailer && whole == nullptr) whole = &packet;
  }
  return whole != nullptr ? *whole : first(trip);
}

TripEnd TracedRing::end_of(std::size_t trip) const {
  const SeenPacket& end = last(trip);
  if (!end.home()) return TripEnd::not_home;
  if (!end.trailer) return TripEnd::broken;
  if (end.info.crc_bad) return TripEnd::damaged;
  return end.trailer->fbc == 0 ? TripEnd::refused : TripEnd::home;
}

std::optional<std::chrono::nanoseconds> TracedRing::round_trip(std::size_t trip) const {
  if (end_of(trip) == TripEnd::not_home) return std::nullopt;
  std::size_t begin = trip;
  while (before_[begin]) begin = *before_[begin];
  if (first(begin).stage() != 0) return std::nullopt;
  return last(trip).last - first(begin).began;
}

// Stage 2 h is the way out of the h-th node, stage 2 h - 1 the way into it.
std::vector<Hop> TracedRing::hops_of(std::size_t trip) const {
  std::vector<Hop> hops;
  std::optional<unsigned> place;
  for (const std::size_t seen : trips_[trip].seen) {
    const SeenPacket& packet = packets_[seen];
    const unsigned here = (packet.stage() + 1) / 2;
    // HOP counts nodes that relay: it may stay while the node is another, where one was bypassed meanwhile.
    if (place != here || hops.back().node != packet.seen_by()) {
      const unsigned expected = place ? *place + 1 : 0;
      hops.emplace_back();
      hops.back().node = packet.seen_by();
      hops.back().unseen = here > expected ? here - expected : 0;
    }
    place = here;
    (packet.info.input ? hops.back().in : hops.back().out) = packet;
  }
  for (Hop& hop : hops) add_company(hop);
  return hops;
}

void TracedRing::add_company(Hop& hop) const {
  if (!hop.out) return;
  const LineHistory& line = outputs_.at(hop.node);
  if (hop.in) hop.behind = line.in_front_of(*hop.in, *hop.out);
  if (!hop.out->interrupt()) hop.cut_by = line.inside(*hop.out);
}

PacketTrace TracedRing::trace(std::size_t trip) const {
  PacketTrace trace;
  trace.source = first(trip).source;
  trace.code = first(trip).code;
  trace.size = first(trip).size;
  trace.trailer = clearest(trip).trailer;
  trace.hops = hops_of(trip);
  trace.end = end_of(trip);
  trace.began = first(trip).began;
  trace.ended = last(trip).last;
  for (auto before = before_[trip]; before; before = before_[*before]) {
    const SeenPacket& out = first(*before);
    trace.earlier.insert(trace.earlier.begin(), {out.code, end_of(*before), last(*before), out.began});
  }
  return trace;
}

namespace {

bool fits(const TracedRing& ring, std::size_t trip, const TripChoice& choice) {
  const SeenPacket& first = ring.first(trip);
  if (choice.source && *choice.source != first.source) return false;
  if (choice.sequence && *choice.sequence != wire::code_of(first.code).sequence) return false;
  return !choice.at || (first.began <= *choice.at && *choice.at <= ring.last(trip).last);
}

}  // namespace

std::vector<std::size_t> choose_trips(const TracedRing& ring, const TripChoice& choice) {
  using std::chrono::nanoseconds;
  const bool by_hand = choice.sequence || choice.at;
  std::vector<std::pair<nanoseconds, std::size_t>> chosen;
  for (std::size_t trip = 0; trip < ring.trips(); ++trip) {
    const auto round_trip = ring.round_trip(trip);
    if ((!round_trip && !by_hand) || !fits(ring, trip, choice)) continue;
    const nanoseconds took = round_trip.value_or(nanoseconds::max());
    if (!choice.over || took > *choice.over) chosen.emplace_back(took, trip);
  }
  std::stable_sort(chosen.begin(), chosen.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::size_t> trips;
  for (const auto& [took, trip] : chosen) trips.push_back(trip);
  return trips;
}

}  // namespace limb_ring::capture
