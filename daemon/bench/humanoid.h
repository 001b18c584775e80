#pragma once

#include <string>

#include "bench/setup.h"
#include "live/private_folder.h"

namespace limb_ring::bench {

/// Writes the humanoid's file with other rates.
/// @param state_rate Hz, of its limb nodes
/// @param bridge the section `bridge` begins so, such as "rate: 1000"
/// @return the file's path
/// @throw std::runtime_error where that file has changed
std::string write_humanoid(const Setup& setup, const live::PrivateFolder& folder, unsigned state_rate,
                           const std::string& bridge);

}  // namespace limb_ring::bench
