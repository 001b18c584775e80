#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace limb_ring::config {

/// The key of a ring's UDP lines.
using KeyBytes = std::array<std::uint8_t, 32>;

/// Reads a key that make_key_file() has made.
/// @throw ConfigError where it cannot be read, is not ours alone (owner, mode 0600), or holds no key
KeyBytes read_key_file(const std::string& path);

/// Makes a file of mode 0600 with a new random key: 64 hexadecimal digits and a newline.
/// @throw ConfigError where there is a file already, or none can be made
void make_key_file(const std::string& path);

}  // namespace limb_ring::config
