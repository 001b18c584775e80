#pragma once

#include <vector>

#include "core/time.h"
#include "wire/control_message.h"

namespace limb_ring::core {

/// What a node knows of another from its hello and beacons.
struct Peer {
  bool known = false;  ///< a hello or beacon of it was heard
  bool beacon_heard = false;
  std::uint64_t boot = 0;
  std::uint8_t hop = 0;  ///< relays between it and this node, of its last control packet
  Time heard_at{};
  Time beacon_at{};     ///< when its last beacon was heard
  wire::Beacon beacon;  ///< its last one

  template <class Archive>
  void archive(Archive& a) {
    a("known", known)("beacon_heard", beacon_heard)("boot", boot)("hop", hop)("heard_at", heard_at)(
        "beacon_at", beacon_at)("beacon", beacon);
  }
};

/// All others, by id.
class Peers {
 public:
  const Peer& operator[](wire::NodeId node) const { return peers_[node]; }

  /// @return true where the boot number is another than the one known (or the first)
  bool heard_hello(wire::NodeId node, std::uint8_t hop, const wire::Hello& hello, Time now) {
    Peer& peer = peers_[node];
    const bool is_new = !peer.known || peer.boot != hello.boot;
    hear(peer, hop, hello.boot, now);
    return is_new;
  }

  /// @return true where it says something new of CPU, links or break, or is the first of its boot number
  bool heard_beacon(wire::NodeId node, std::uint8_t hop, const wire::Beacon& beacon, Time now) {
    Peer& peer = peers_[node];
    const bool news = !peer.beacon_heard || wire::is_news(peer.beacon, beacon);
    hear(peer, hop, beacon.boot, now);
    peer.beacon_heard = true;
    peer.beacon_at = now;
    peer.beacon = beacon;
    return news;
  }
  void forget_all() { peers_.assign(peers_.size(), {}); }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("peers", peers_);
  }

 private:
  static void hear(Peer& peer, std::uint8_t hop, std::uint64_t boot, Time now) {
    peer.known = true;
    peer.boot = boot;
    peer.hop = hop;
    peer.heard_at = now;
  }
  std::vector<Peer> peers_ = std::vector<Peer>(256);  ///< on the heap: kept away from what every hop reads
};

}  // namespace limb_ring::core
