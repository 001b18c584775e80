#pragma once

#include "config/entry.h"
#include "config/ring_config.h"
#include "config/value_readers.h"

namespace limb_ring::config {

/// The entry `urdf`: reads that file into the document. @throw ConfigError
void read_urdf(const Entry& entry);

/// The document's URDF, where it has one, gives a joint its limits, until the ring's file says otherwise.
/// @param name the entry with the joint's name
/// @throw ConfigError where the URDF has no joint of that name, or one that does not turn
void take_urdf_limits(const Entry& name, JointConfig& joint);

/// Refuses a limit that the ring's file leaves to the URDF, and that the URDF does not give or not within `range`.
/// @param entry the joint's @param limit lower, upper, velocity or effort
void check_urdf_limit(const Entry& entry, const JointConfig& joint, const std::string& limit, RealRange range);

}  // namespace limb_ring::config
