#pragma once

#include <map>
#include <ostream>
#include <string>
#include <tuple>

#include "wire/packet_view.h"

namespace limb_ring::capture {

/// Whose packets a file holds.
struct RingNames {
  std::string ring;
  std::map<wire::NodeId, std::string> nodes;

  /// Its name, or its number where it has none.
  std::string of(std::uint8_t node) const;
  /// "left_hip -> left_knee"
  std::string line(std::uint8_t from, std::uint8_t to) const { return of(from) + " -> " + of(to); }
};

/// Writes packets as pcapng, which Wireshark reads: every line of the ring an interface, times in ns.
/// The stream's own state says whether writing has failed.
class PcapngWriter {
 public:
  PcapngWriter(std::ostream& out, RingNames names);

  /// @param time_ns since 1970, or of a virtual clock since its start
  /// @param lost_before packets that are missing before this one
  /// @param comment that Wireshark shows with it
  void packet(std::int64_t time_ns, const CaptureInfo& info, wire::ByteView bytes, std::uint32_t lost_before = 0,
              const std::string& comment = {});
  /// Something that happened at a node and is no packet: a fault, a reset, a change of state.
  void event(std::int64_t time_ns, wire::NodeId node, const std::string& what);

 private:
  using Line = std::tuple<bool, wire::NodeId, wire::NodeId>;  ///< of events, from, to

  std::uint32_t interface_of(const Line& line, const std::string& name);

  std::ostream& out_;
  RingNames names_;
  std::map<Line, std::uint32_t> interfaces_;
};

}  // namespace limb_ring::capture
