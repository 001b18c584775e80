#include "node/neighbour_watch.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace limb_ring::runtime {
namespace {

/// Looks in a row at which a neighbour's fault has to be seen: beacons of one instant tell of a ring that changes.
constexpr unsigned kHopLooks = 3, kRelayLooks = 5;

std::string times(std::uint64_t count, const char* one, const char* many) {
  return std::to_string(count) + ' ' + (count == 1 ? one : many) + " in 10 s";
}

}  // namespace

/// A counter that grows by more than `most` within kWindow.
struct NeighbourWatch::Rule {
  const char* name;
  std::uint64_t most;
  std::uint64_t (*value)(const Look&);
  std::string (*text)(const NeighbourWatch&, const Look&, std::uint64_t count);
};

const std::array<NeighbourWatch::Rule, 8> NeighbourWatch::kCounted{{
    {"malformed", 0, [](const Look& look) { return look.counters.malformed_packets; },
     [](const NeighbourWatch& watch, const Look& look, std::uint64_t count) {
       return times(count, "packet", "packets") + " from " + watch.upstream(look) +
              " with a wrong header or trailer, the last of source " + watch.name(look.counters.last_malformed.source) +
              " (protocol.md section 2.2)";
     }},
    {"oversize", 0, [](const Look& look) { return look.counters.oversize_packets; },
     [](const NeighbourWatch& watch, const Look& look, std::uint64_t count) {
       return times(count, "packet", "packets") + " from " + watch.upstream(look) +
              " of more than 524 bytes, the last of source " + watch.name(look.counters.last_oversize.source) +
              " (protocol.md section 3.1)";
     }},
    // The rest of a packet that was broken off is stray, too.
    {"stray", 20, [](const Look& look) { return look.counters.stray_slices; },
     [](const NeighbourWatch& watch, const Look& look, std::uint64_t count) {
       return times(count, "slice", "slices") + " from " + watch.upstream(look) +
              " that belong to no packet (protocol.md section 6.3)";
     }},
    {"no_slice", 0, [](const Look& look) { return look.no_slices; },
     [](const NeighbourWatch& watch, const Look& look, std::uint64_t count) {
       return times(count, "stream or datagram", "streams or datagrams") + " from " + watch.upstream(look) +
              " that held no slice (protocol.md section 6.2)";
     }},
    {"control", 0, [](const Look& look) { return look.counters.control_malformed; },
     [](const NeighbourWatch& watch, const Look& look, std::uint64_t count) {
       return times(count, "packet", "packets") + " on channel 1, neither hello nor beacon, the last of source " +
              watch.name(look.counters.last_control.source) + " (protocol.md section 2.3)";
     }},
    // After a start of one's own some are left that nobody has taken off the ring.
    {"duplicate_id", 3, [](const Look& look) { return look.counters.duplicate_id_signs; },
     [](const NeighbourWatch& watch, const Look& look, std::uint64_t count) {
       return times(count, "sign", "signs") + " that another node has the id of this one, " +
              std::to_string(watch.self_) + ", the last one's HOP is " +
              std::to_string(look.counters.last_duplicate.hop) + " (protocol.md section 8.6)";
     }},
    {"other_session", 20, [](const Look& look) { return look.other_session; },
     [](const NeighbourWatch& watch, const Look& look, std::uint64_t count) {
       return times(count, "datagram", "datagrams") + " from " + watch.name(look.other_session_of) +
              " of a session that this node does not have (protocol.md section 6.7)";
     }},
    {"flapping", 4, [](const Look& look) { return look.line_losses; },
     [](const NeighbourWatch&, const Look& look, std::uint64_t count) {
       return "a line of this node was lost " + times(count, "time", "times") + ", the last: " + look.last_loss;
     }},
}};

std::string NeighbourWatch::upstream(const Look& look) const {
  return look.from ? name(*look.from) : std::string("upstream");
}

bool NeighbourWatch::is_fresh(std::uint8_t node, const Look& look) const {
  const core::Peer& peer = look.peers[wire::NodeId{node}];
  return peer.beacon_heard && look.now - peer.beacon_at <= wire::kMissedBeacons * ring_.timeouts.beacon;
}

/// What the upstream neighbour sends itself comes with HOP 0, and what it passes on of its own neighbour with HOP 1.
std::string NeighbourWatch::hop_of_neighbour(const Look& look) const {
  if (look.state != core::NodeState::up || !look.from || !is_fresh(*look.from, look)) return "";
  const auto wrong = [&](const std::string& whose, unsigned hop, const char* right) {
    return name(*look.from) + ": HOP of " + whose + " is " + std::to_string(hop) + ", " + right +
           " expected (protocol.md section 2.2)";
  };
  const core::Peer& neighbour = look.peers[wire::NodeId{*look.from}];
  if (neighbour.hop != 0) return wrong("its own packets", neighbour.hop, "0");
  if (neighbour.beacon.input != wire::LinkState::up) return "";
  const std::uint8_t before = neighbour.beacon.input_from;
  if (before != self_ && !is_fresh(before, look)) return "";
  const unsigned hop =
      before == self_ ? static_cast<unsigned>(look.ring_size) - 1 : look.peers[wire::NodeId{before}].hop;
  if (hop == 1) return "";
  return wrong("packets of " + name(before), hop, "1");
}

/// Its beacons come, and say that its input is up; of what should come in there nothing comes here.
std::string NeighbourWatch::relay_of_neighbour(const Look& look) const {
  if (!look.from || !is_fresh(*look.from, look)) return "";
  const core::Peer& neighbour = look.peers[wire::NodeId{*look.from}];
  if (neighbour.beacon.input != wire::LinkState::up) return "";
  const std::uint8_t before = neighbour.beacon.input_from;
  const bool own_is_lost = before == self_ && look.state == core::NodeState::joining;
  const core::Peer& other = look.peers[wire::NodeId{before}];
  const bool other_is_lost =
      before != self_ && (!other.known || look.now - other.heard_at > wire::kMissedBeacons * ring_.timeouts.beacon);
  if (!own_is_lost && !other_is_lost) return "";
  return name(*look.from) + " passes nothing on: it hears " + (own_is_lost ? "this node" : name(before)) +
         ", and only its own packets come (protocol.md section 2.2)";
}

void NeighbourWatch::tell(const char* rule, Kept& kept, const std::string& text, const Look& look,
                          std::vector<std::string>& log) {
  warnings_.push_back({rule, text});
  if (kept.told && look.now - *kept.told < kToldAgain) return;
  kept.told = look.now;
  log.push_back(text);
}

void NeighbourWatch::judge(const Rule& rule, Kept& kept, const Look& look, std::vector<std::string>& log) {
  const std::uint64_t value = rule.value(look);
  std::rotate(kept.grown.rbegin(), kept.grown.rbegin() + 1, kept.grown.rend());
  kept.grown.front() = value - std::exchange(kept.value, value);
  const std::uint64_t count = std::accumulate(kept.grown.begin(), kept.grown.end(), std::uint64_t{0});
  if (count > rule.most) tell(rule.name, kept, rule.text(*this, look, count), look, log);
}

std::vector<std::string> NeighbourWatch::look(const Look& look) {
  looked_ = look.now;
  warnings_.clear();
  std::vector<std::string> log;
  for (std::size_t i = 0; i < kCounted.size(); ++i) judge(kCounted[i], counted_[i], look, log);
  const auto lasting = [&](const char* rule, Kept& kept, const std::string& found, unsigned looks) {
    kept.looks = found.empty() ? 0 : kept.looks + 1;
    if (kept.looks >= looks) tell(rule, kept, found, look, log);
  };
  lasting("hop", hop_, hop_of_neighbour(look), kHopLooks);
  lasting("relay", relay_, relay_of_neighbour(look), kRelayLooks);
  return log;
}

}  // namespace limb_ring::runtime
