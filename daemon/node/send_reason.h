#pragma once

#include <algorithm>
#include <chrono>
#include <string>

#include "config/ring_config.h"
#include "core/events.h"
#include "core/membership/membership.h"
#include "core/network_controller.h"
#include "limb_ring/host_port.h"
#include "node/cpu_socket.h"
#include "node/node_driver.h"

namespace limb_ring::runtime {

/// Why one send ended otherwise than delivered.
struct SendReason {
  Reason reason = Reason::none;
  std::string text;  ///< for people; says "probably" if it is an inference
};

/// Why sends of this node ended as they did. A refused packet comes home without a reason, so the reason is inferred:
/// for a pin from the ring's file, for data from the destination's last beacon, for the own CPU from its state. (ours)
class SendReasons {
 public:
  /// All must outlive this.
  SendReasons(const config::RingConfig& ring, const config::NodeConfig& self, const CpuSocket& cpu,
              const NodeDriver& driver)
      : ring_(ring), self_(self), cpu_(cpu), driver_(driver) {}

  SendReason of(const core::SendEnded& ended) const;

 private:
  SendReason refused_data(const core::SendEnded& ended) const;
  SendReason refused_by_some() const;
  SendReason refused_interrupt(const core::SendEnded& ended) const;
  SendReason unconfirmed(const core::SendEnded& ended) const;
  SendReason rejected(const core::SendEnded& ended) const;
  std::string name_of(wire::NodeId id) const;
  const core::Membership& membership() const { return driver_.controller().membership(); }

  const config::RingConfig& ring_;
  const config::NodeConfig& self_;
  const CpuSocket& cpu_;
  const NodeDriver& driver_;
};

/// The client library's word for the core's.
limb_ring::Outcome public_outcome(core::Outcome outcome);

/// How long one who sends a packet as the last one ends, with `period` between, waits for the next. A rejection comes
/// at once: sending again at once would keep the event loop, or the clock of a virtual ring, from all else. (ours)
inline std::chrono::nanoseconds pause_after(core::Outcome outcome, std::chrono::nanoseconds period) {
  constexpr std::chrono::nanoseconds kAfterRejection = std::chrono::milliseconds(1);
  return outcome == core::Outcome::rejected ? std::max(period, kAfterRejection) : period;
}

}  // namespace limb_ring::runtime
