#pragma once

#include <CLI/CLI.hpp>

namespace limb_ring::ringctl {

/// What --channel takes: 0 to 63, or the name of one that has one.
/// @param control also channel 1, which is the network controllers' own
CLI::Validator channel(bool control);

}  // namespace limb_ring::ringctl
