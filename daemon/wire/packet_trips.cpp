#include "wire/packet_trips.h"

#include <array>
#include <map>
#include <utility>

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

}  // namespace limb_ring::capture
