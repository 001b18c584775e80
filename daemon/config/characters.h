#pragma once

#include <cstddef>
#include <string>

namespace limb_ring::config {

/// ASCII alone, whatever the locale says.
inline bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
/// Digits alone, 1 to `most` of them: up to 9, std::stoi() takes it.
bool are_digits(const std::string& text, std::size_t most = std::string::npos);

/// UTF-8 without control characters: can be printed, and written into JSON and XML as it is.
bool is_plain_text(const std::string& text);

/// Fit for one line of an error message, whatever was given: control characters are '?', and of what is long the first
/// 60 bytes are shown, and "...".
std::string printable(const std::string& text);

}  // namespace limb_ring::config
