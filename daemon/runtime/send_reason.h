#pragma once

#include <string>

#include "config/ring_config.h"
#include "core/events.h"
#include "core/membership/membership.h"
#include "limb_ring/reason.h"

namespace limb_ring::runtime {

struct SendReason {
  Reason reason = Reason::none;
  std::string text;  ///< for people; says "probably" where it is an inference
};

/// Why a send of `own` ended as it did. Of a refusal the ring brings home no more than that it was one: of a pin the
/// ring's file tells, of a packet the last beacon of the destination. (ours)
/// @param own_cpu the state of the own CPU, for what was sent to itself
SendReason reason_of(const core::SendEnded& ended, const config::RingConfig& ring, const config::NodeConfig& own,
                     wire::CpuState own_cpu, const core::Membership& membership);

}  // namespace limb_ring::runtime
