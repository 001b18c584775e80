#pragma once

#include <string>

#include "bench/setup.h"
#include "ring/private_folder.h"

namespace limb_ring::bench {

/// Writes a copy of the humanoid's file with other rates.
/// @param state_rate Hz, of its limb nodes
/// @param bridge text for the beginning of the section `bridge`, such as "rate: 1000"
/// @return the copy's path
/// @throw std::runtime_error if the humanoid's file no longer has the text that is to be replaced
std::string write_humanoid(const Setup& setup, const live::PrivateFolder& folder, unsigned state_rate,
                           const std::string& bridge);

}  // namespace limb_ring::bench
