#pragma once

#include <CLI/CLI.hpp>

namespace limb_ring::ringctl {

/// What --channel takes: 0 to 63, or the name of one that has one.
CLI::Validator any_channel();
/// The same without channel 1, which is the network controllers' own.
CLI::Validator channel_of_clients();

}  // namespace limb_ring::ringctl
