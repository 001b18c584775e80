#pragma once

#include <bitset>
#include <optional>

#include "core/counters.h"
#include "core/mutation.h"
#include "core/settings.h"

namespace limb_ring::core {

/// Relay: passes every incoming packet on with HOP + 1, and discards a packet whose SID is its
/// own. (paper) What becomes of orphans, whose source can no longer discard them, is ours (protocol.md
/// sections 2.2 and 4.9).
class Relay {
 public:
  enum class Fate : std::uint8_t {
    pass_on,
    strip,         ///< own: it has come home
    receive_only,  ///< its source is bypassed by this node's output: taken, then discarded
    discard        ///< an orphan by its HOP or beyond a break, or no packet at all
  };

  Relay(const Settings& settings, Counters& counters) : settings_(settings), counters_(counters) {}

  /// What becomes of a packet, known as soon as its header is in. @pre header.size >= 4
  Fate fate(wire::ByteView header, bool interrupt) {
    if (!wire::header_valid(header, interrupt)) return ++counters_.malformed_packets, Fate::discard;
    const NodeId source = header[3];
    if (source == settings_.id) return Fate::strip;
    if (broken(Mutation::passes_orphans)) return Fate::pass_on;
    if (cut_off_[source]) return ++counters_.orphans_cut_off, Fate::discard;
    if (header[2] + 1u >= settings_.nodes()) return ++counters_.orphans_hop, Fate::discard;
    if (bypassed_[source]) return ++counters_.orphans_bypassed, Fate::receive_only;
    return Fate::pass_on;
  }

  /// The output now leads to `successor`: nodes between it and this one are bypassed.
  void set_successor(NodeId successor) { bypassed_ = between(settings_.id, successor); }
  /// What comes in was turned back at `node`. Nodes between it and this one are beyond the break: what still comes of
  /// them has passed here before the line broke. Nothing: the input is the first line. (ours,
  /// protocol.md section 4.9)
  void set_turned_back_at(std::optional<NodeId> node) {
    cut_off_ = node ? between(*node, settings_.id) : std::bitset<256>{};
  }

 private:
  /// The nodes that come after `before` and before `behind` in ring order.
  std::bitset<256> between(NodeId before, NodeId behind) const {
    std::bitset<256> nodes;
    const auto& order = settings_.order;
    std::size_t at = 0;
    while (order[at] != before) ++at;
    for (std::size_t i = 1; i < order.size(); ++i) {
      const NodeId next = order[(at + i) % order.size()];
      if (next == behind) break;
      nodes.set(next);
    }
    return nodes;
  }

  const Settings& settings_;
  Counters& counters_;
  std::bitset<256> bypassed_;
  std::bitset<256> cut_off_;
};

}  // namespace limb_ring::core
