#pragma once

#include <ostream>
#include <string>

#include "sim/virtual_ring.h"

namespace limb_ring::sim {

/// Everything that leaves a node, every event and every packet a CPU gets, in its order: as a hash,
/// and as lines of text if somebody wants to read them. The same seed and configuration give the
/// same trace, on any build.
///
///   time in ps, node, what, and of a slice: size, its last four bytes, CRC-32 of those before them
class Trace : public Observer {
 public:
  /// @param text where lines go, null for the hash alone; must live as long as the ring runs
  explicit Trace(VirtualRing& ring, std::ostream* text = nullptr) : text_(text) { ring.add_observer(*this); }

  /// Of all so far.
  std::uint64_t hash() const { return hash_; }

  void leaves(NodeId node, const wire::Slice& slice, Time now) override;
  void event(NodeId node, const core::Event& event) override;
  void packet(NodeId node, const core::ReceivedPacket& packet) override;
  void incident(NodeId node, Incident incident, Time now, Line line) override;

 private:
  void record(Time now, NodeId node, const char* what, std::uint64_t a, std::uint64_t b, std::uint64_t c);

  std::ostream* text_;
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

/// "killed", "slice lost"
const char* to_string(Incident incident);

/// The hash as it is printed: 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

}  // namespace limb_ring::sim
