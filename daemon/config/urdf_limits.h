#pragma once

#include "config/entry.h"
#include "config/ring_config.h"

namespace limb_ring::config {

/// The entry `urdf`: reads that file into the document. @throw ConfigError
void read_urdf(const Entry& entry);

/// The document's URDF, if it has one, gives a joint its type and limits, until the ring's file says otherwise.
/// @param name the entry with the joint's name
/// @throw ConfigError if the URDF has no joint of that name, or one without a motor
void take_urdf_limits(const Entry& name, JointConfig& joint);

/// The limits of that type of joint that were not given.
void take_usual_limits(JointConfig& joint);

/// Notes a limit that the ring's file leaves to the URDF, and that the URDF does not give.
/// @param entry the joint's @param limit lower, upper, velocity or effort
/// @throw ConfigError if something stands there that is not a number
void check_urdf_limit(const Entry& entry, const JointConfig& joint, const std::string& limit);

/// What was noted, in one sentence that names all joints; none if nothing was.
std::vector<std::string> urdf_warnings(const Document& document);

/// The URDF's mimic joints whose leader is a joint of the ring.
void take_followers(const UrdfJoints& urdf, RingConfig& ring);

}  // namespace limb_ring::config
