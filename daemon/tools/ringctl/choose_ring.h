#pragma once

#include <string>

namespace limb_ring::ringctl {

/// The ring given, else the environment's LIMB_RING_RING; empty where neither names one.
/// @throw UsageError where that cannot be a ring's name
std::string named_ring(const std::string& given);

/// The ring that a command is for: the one given, else the environment's LIMB_RING_RING, else the only one
/// running, else the only one that is dead because its daemons were killed on purpose.
/// @throw NoRing where there is none; UsageError listing them where several run.
std::string choose_ring(const std::string& given);

/// The same for a command that takes the name as its argument RING, too; each may be empty.
/// @throw also UsageError where the two differ
std::string choose_ring(const std::string& argument, const std::string& option);

}  // namespace limb_ring::ringctl
