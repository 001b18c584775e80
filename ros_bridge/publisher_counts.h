#pragma once

#include <map>
#include <string>

namespace limb_ring::bridge {

/// How many nodes publish each topic, by its full name, as the master has it: also those that have died without telling
/// it. Empty where it does not answer; one that is gone is not waited for.
std::map<std::string, unsigned> publisher_counts();

}  // namespace limb_ring::bridge
