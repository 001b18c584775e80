#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace limb_ring::ringctl {

/// Bytes written as hexadecimal digits, two each; spaces, ':' and a leading 0x are passed over.
/// @throw UsageError naming what is no digit, or an odd number of them
std::vector<std::uint8_t> parse_hex(const std::string& text);

}  // namespace limb_ring::ringctl
