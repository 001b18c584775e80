#pragma once

#include <exception>
#include <string>
#include <vector>

#include "ring/live_faults.h"

namespace limb_ring::ringctl {

/// The result of a fault at its nodes.
struct BegunFaults {
  std::vector<live::Begun> done;
  std::exception_ptr problem;  ///< why it was not done at the others: NotDone or HostPortError; null: it was at all
};

/// As LiveFaults::begin(), but what was done before something failed elsewhere is told.
BegunFaults begin_fault(const std::string& ring, const fault::RingNodes& nodes, const fault::Fault& fault,
                        const live::LiveFaults::Wait& wait);

/// `ringctl fault list`: one line a fault, for people.
std::string fault_table(const std::vector<status::Fault>& faults);

}  // namespace limb_ring::ringctl
