#pragma once

namespace limb_ring::config {

/// ASCII alone, whatever the locale says.
inline bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace limb_ring::config
