#pragma once

#include <memory>
#include <ostream>
#include <vector>

#include "config/ring_config.h"
#include "sim/invariants.h"
#include "sim/virtual_ring.h"
#include "wire/packet_assembler.h"
#include "wire/pcapng.h"

namespace limb_ring::sim {

/// What a line is taken for if nothing else is said. (ours)
constexpr std::uint64_t kUsualRate = 1'000'000'000;        ///< bit/s
constexpr std::chrono::nanoseconds kUsualRelayDelay{512};  ///< d: line and node

/// Rate and delay for lines without a rate in the file.
/// @param rate bit/s @return the ring with every line's rate given
config::RingConfig with_assumed_lines(config::RingConfig ring, std::uint64_t rate, std::chrono::nanoseconds delay);
/// Whether there is a line without a rate.
bool assumes_lines(const config::RingConfig& ring);

/// The ring of a file under a virtual clock: every core as setup::core_settings() has it, but for the ids,
/// which are the places in ring order. Each line has its own rate and delay.
/// @param ring every line has a rate; outlives the result
std::unique_ptr<WatchedRing> planned_ring(const config::RingConfig& ring, const std::vector<int>& drifts = {});

/// Where packets are captured: as they come into a node, so that what faults did to them shows; or as
/// they go out of one as well, so that what they waited for shows.
enum class CaptureAt : std::uint8_t { inputs, inputs_and_outputs };

/// Writes what is on the lines of a virtual ring as pcapng, in virtual time; every line an interface.
/// Faults, states and pins are events. Must live as long as the ring runs.
class RingCapture : public Observer {
 public:
  RingCapture(VirtualRing& ring, std::ostream& out, capture::RingNames names, CaptureAt at = CaptureAt::inputs);

  void leaves(wire::NodeId node, const wire::Slice& slice, core::Time now) override;
  void arrives(wire::NodeId node, const wire::Slice& slice, core::Time now) override;
  void event(wire::NodeId node, const core::Event& event) override;
  void incident(wire::NodeId node, Incident incident, core::Time now, core::Line line) override;

 private:
  wire::NodeId upstream(wire::NodeId node) const;
  wire::NodeId downstream(wire::NodeId node) const;
  void write(const capture::PacketView& packet);

  VirtualRing& ring_;
  capture::PcapngWriter writer_;
  std::vector<capture::PacketAssembler> inputs_, outputs_;  ///< by node; outputs_ empty if not looked at
};

/// The nodes' names by their ids, as the ring's file has them.
capture::RingNames names_of(const config::RingConfig& ring);
/// Names of a ring of plain nodes: node0, node1 ...
capture::RingNames plain_names(unsigned nodes);

}  // namespace limb_ring::sim
