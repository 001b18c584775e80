#pragma once

#include <limb_ring/ClearFaults.h>
#include <limb_ring/InjectFault.h>
#include <limb_ring/ListFaults.h>

#include <string>

#include "config/ring_config.h"
#include "ring/live_faults.h"
#include "ros_bridge/ring_port.h"
#include "ros_bridge/two_names.h"

namespace limb_ring::bridge {

/// `inject_fault`, `clear_faults`, `list_faults`: what `ringctl fault` does, for the whole ring as far as its
/// daemons run on this host. A call returns when it has taken effect, or by a deadline; what went wrong is
/// in its message.
class FaultServices {
 public:
  /// @param own the bridge's node
  FaultServices(TwoNames& names, const config::RingConfig& ring, const std::string& own, RingPort& port);

 private:
  bool inject(InjectFault::Request& request, InjectFault::Response& response);
  bool clear(ClearFaults::Request& request, ClearFaults::Response& response);
  bool list(ListFaults::Request& request, ListFaults::Response& response);
  void require_survival(const fault::Fault& fault) const;

  fault::RingNodes ring_nodes_;
  std::string own_;
  RingPort& port_;  ///< its time goes on during a call
  live::LiveFaults faults_;
};

}  // namespace limb_ring::bridge
