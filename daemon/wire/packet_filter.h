#pragma once

#include <bitset>

#include "wire/packet_assembler.h"

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
  /// it passes if those do not matter, and counts as data.
  bool passes(const PacketView& packet) const;

 private:
  bool trailer_passes(const PacketView& packet) const;
};

Kind kind_of(const PacketView& packet);

/// What one observer has asked for.
struct Choice {
  Filter filter;
  std::uint32_t sample = 1;       ///< of the packets that pass the filter, every so many-th
  std::uint32_t limit_per_s = 0;  ///< at most so many in any whole second; 0: no limit
};

/// Chooses packets for one observer, and counts what it leaves out, and why.
class Selection {
 public:
  explicit Selection(const Choice& choice) : choice_(choice) {}

  /// Whether the observer gets this packet; if not, the reason is counted.
  bool takes(const PacketView& packet);
  /// What became of one that was taken.
  void given() {
    ++counts_.given;
    lost_before_ = 0;
  }
  void lost() {
    ++counts_.lost;
    ++lost_before_;
  }
  const Filter& filter() const { return choice_.filter; }
  /// Lost since one was given.
  std::uint32_t lost_before() const { return lost_before_; }
  const CaptureCounts& counts() const { return counts_; }

 private:
  bool within_limit(std::chrono::nanoseconds at);

  Choice choice_;
  CaptureCounts counts_;
  std::uint32_t lost_before_ = 0;
  std::uint64_t passed_ = 0;
  std::int64_t second_ = -1;
  std::uint32_t in_second_ = 0;
};

}  // namespace limb_ring::capture
