#pragma once

#include <bitset>

#include "core/counters.h"
#include "core/mutation.h"
#include "core/settings.h"

namespace limb_ring::core {

/// Relay: passes every incoming packet on with HOP + 1, and discards a packet whose SID is its
/// own. (paper) What becomes of orphans, whose source can no longer discard them, is ours.
class Relay {
 public:
  enum class Fate : std::uint8_t {
    pass_on,
    strip,         ///< own: it has come home
    receive_only,  ///< its source is bypassed by this node's output: taken, then discarded
    discard        ///< an orphan by its HOP, or no packet at all
  };

  Relay(const Settings& settings, Counters& counters) : settings_(settings), counters_(counters) {}

  /// What becomes of a packet, known as soon as its header is in. @pre header.size >= 4
  Fate fate(wire::ByteView header, bool interrupt) {
    if (!wire::header_valid(header, interrupt)) return ++counters_.malformed_packets, Fate::discard;
    const NodeId source = header[3];
    if (source == settings_.id) return Fate::strip;
    if (broken(Mutation::passes_orphans)) return Fate::pass_on;
    if (header[2] + 1u >= settings_.nodes()) return ++counters_.orphans_hop, Fate::discard;
    if (bypassed_[source]) return ++counters_.orphans_bypassed, Fate::receive_only;
    return Fate::pass_on;
  }

  /// The output now leads to `successor`: nodes between it and this one are bypassed.
  void set_successor(NodeId successor) {
    bypassed_.reset();
    const auto& order = settings_.order;
    std::size_t at = 0;
    while (order[at] != settings_.id) ++at;
    for (std::size_t i = 1; i < order.size(); ++i) {
      const NodeId next = order[(at + i) % order.size()];
      if (next == successor) return;
      bypassed_.set(next);
    }
  }

 private:
  const Settings& settings_;
  Counters& counters_;
  std::bitset<256> bypassed_;
};

}  // namespace limb_ring::core
