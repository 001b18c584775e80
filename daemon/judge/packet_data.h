#pragma once

#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

#include "wire/packet.h"

namespace limb_ring::recorder {

/// What a packet is known by wherever it is: its CRC and the fields that no relay changes.
std::uint64_t key_of(const wire::PacketFields& packet);

/// The data of packets, for the recordings of nodes that they only pass: these have all but the data. (ours)
class PacketData {
 public:
  /// Packets of which it keeps the data, the newest.
  static constexpr std::size_t kMost = 4096;

  /// @param packet a whole DATP whose CRC is right
  void keep(wire::ByteView packet);
  /// Fills in the data of a packet of which all else is there: as it was kept, or else made up, so that the CRC is
  /// right. To a node that it only passes that makes no difference.
  /// @param size bytes of the packet, at least kLeastAbridged
  /// @return false: made up
  bool fill_in(std::uint8_t* packet, std::size_t size);
  /// Its data is here: kept, or made up.
  bool knows(wire::ByteView packet) const { return packets_.count(key_of({packet})) != 0; }
  /// The data of that packet was made up.
  bool is_made_up(wire::ByteView packet) const;

 private:
  struct Kept {
    std::vector<std::uint8_t> data;
    bool made_up = false;
  };
  void put(std::uint64_t key, wire::ByteView data, bool made_up);

  std::unordered_map<std::uint64_t, Kept> packets_;
  std::deque<std::uint64_t> order_;  ///< of their arrival
};

}  // namespace limb_ring::recorder
