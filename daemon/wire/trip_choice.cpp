#include "wire/trip_choice.h"

#include <algorithm>

namespace limb_ring::capture {

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
