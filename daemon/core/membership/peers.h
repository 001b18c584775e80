#pragma once

#include <optional>
#include <vector>

#include "core/time.h"
#include "wire/control_message.h"

namespace limb_ring::core {

using wire::NodeId;

/// A line of the ring, by the nodes on both sides of it.
struct BrokenLine {
  NodeId before, behind;
};

/// The broken line that this node knows of; it is stored nowhere else. Only the node behind a break is believed: the
/// beacons of others would still tell of the break after it is mended. (ours, protocol.md section 8.3)
class KnownBreak {
 public:
  explicit KnownBreak(NodeId id) : id_(id) {}

  bool known() const { return known_; }
  std::optional<BrokenLine> line() const {
    if (!known_) return std::nullopt;
    return BrokenLine{before_, behind_};
  }
  /// True if the line into this node is the broken one.
  bool is_own() const { return known_ && behind_ == id_; }

  /// The line from `before` into this node counts as broken.
  void found(NodeId before) { set(before, id_); }
  /// A beacon of another node came. @return true if it tells of a break that is believed
  bool heard(const wire::Beacon& beacon, NodeId source) {
    if (!beacon.break_known || beacon.break_behind != source || is_own()) return false;
    set(beacon.break_before, beacon.break_behind);
    return true;
  }
  /// A beacon of `source` says that it knows of no break.
  void withdrawn_by(NodeId source) {
    if (behind_ == source) known_ = false;
  }
  /// The line into this node is up again, or the second line no longer stands for it.
  void own_mended() {
    if (is_own()) known_ = false;
  }
  /// No fold is left in the ring: only a break that this node sees itself may still be there.
  void keep_own_alone() { known_ = is_own(); }
  /// The ring is closed again. `folded`: it is closed by the second line, which stands for this node's input; then a
  /// break of the own input is still there.
  void ring_closed(bool folded) { known_ = folded && is_own(); }
  void forget() { known_ = false; }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("known", known_)("before", before_)("behind", behind_);
  }

 private:
  void set(NodeId before, NodeId behind) {
    known_ = true;
    before_ = before;
    behind_ = behind;
  }

  NodeId id_;
  bool known_ = false;
  NodeId before_{0};
  NodeId behind_{0};
};

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

  /// @return true if the boot number is another than the one known (or the first)
  bool heard_hello(wire::NodeId node, std::uint8_t hop, const wire::Hello& hello, Time now) {
    Peer& peer = peers_[node];
    const bool is_new = !peer.known || peer.boot != hello.boot;
    hear(peer, hop, hello.boot, now);
    return is_new;
  }

  /// @return true if it says something new of CPU, links or break, or is the first of its boot number
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
