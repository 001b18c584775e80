#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "core/line.h"
#include "io/input.h"
#include "io/link_header.h"
#include "io/output.h"

namespace limb_ring::setup {

/// What the links of one line are told at one node.
struct LinkSettings {
  core::Line line;
  link::InputSettings input;
  link::OutputSettings output;
};
/// For each line of the ring, out of its configuration.
/// @param directory the ring's folder, where UNIX links live
std::vector<LinkSettings> link_settings(const config::RingConfig& ring, const config::NodeConfig& node,
                                        const std::string& directory);

/// The waits of a line's two ends.
link::Timing timing_of(const config::RingConfig& ring);
/// Ids of all nodes in the order in which the line runs.
std::vector<std::uint8_t> order_on(const config::RingConfig& ring, core::Line line);

/// What all nodes of a ring must agree on, out of its file (protocol.md section 6.13). Not in it, since it may differ
/// from host to host: transport, addresses and ports, `limits`, `realtime`, `firmware`, `bridge`, the commands of CPUs,
/// and waits that concern one node alone.
link::Agreement agreement_of(const config::RingConfig& ring);

}  // namespace limb_ring::setup

namespace limb_ring::config {

/// The key of a ring's UDP lines.
using KeyBytes = std::array<std::uint8_t, 32>;

/// Reads a key that make_key_file() has made.
/// @throw ConfigError if it cannot be read, is not ours alone (owner, mode 0600), or holds no key
KeyBytes read_key_file(const std::string& path);

/// Makes a file of mode 0600 with a new random key: 64 hexadecimal digits and a newline.
/// @throw ConfigError if there is a file already, or none can be made
void make_key_file(const std::string& path);

}  // namespace limb_ring::config
