#pragma once

#include <bitset>

#include "wire/packet_view.h"

namespace limb_ring::capture {

/// What a packet is to its reader: control is channel 1, hello and beacons.
enum class Kind : std::uint8_t { data, control, interrupt };

/// Which packets somebody wants to see. Each condition left empty lets everything pass.
struct Filter {
  bool input = true;             ///< packets that come into the node
  bool output = false;           ///< packets that it puts onto its line
  std::bitset<3> kinds;          ///< by Kind
  std::bitset<256> source;       ///< by SID
  std::bitset<256> destination;  ///< by DID, 255 being broadcast
  std::bitset<4> priority;       ///< data packets alone
  std::bitset<64> channel;       ///< data packets alone

  /// A packet that broke off before its trailer has no known destination, priority and channel:
  /// it passes where those do not matter, and counts as data.
  bool passes(const PacketView& packet) const;

 private:
  bool trailer_passes(const PacketView& packet) const;
};

Kind kind_of(const PacketView& packet);

}  // namespace limb_ring::capture
