#pragma once

#include "limb_ring/host_port.h"

namespace limb_ring::ask {

/// It was delivered, or may have been: in an open chain nothing returns, but what lies behind the break is known.
inline bool may_have_arrived(const Result& result) {
  if (result.outcome == Outcome::unconfirmed) return result.why != Reason::out_of_reach;
  return result.outcome == Outcome::delivered;
}

}  // namespace limb_ring::ask
