#pragma once

#include "core/events.h"

namespace limb_ring::runtime {

/// Owners of sends that are no clients of the host port: clients count up from 1.
constexpr core::Owner kTrafficOwner = 0xFFFFFFFF;
constexpr core::Owner kOrdersOwner = 0xFFFFFFFE;
constexpr core::Owner kBabbleOwner = 0xFFFFFFFD;

}  // namespace limb_ring::runtime
