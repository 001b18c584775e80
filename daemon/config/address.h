#pragma once

#include <string>

namespace limb_ring::config {

/// IPv4 and IPv6 addresses in numbers, however they are written: ::1 is 0:0:0:0:0:0:0:1, too. False of what is none.

bool is_address(const std::string& text);
/// 127.0.0.0/8 and ::1: reached from the same machine alone.
bool is_loopback(const std::string& text);
/// 0.0.0.0 and ::, which stand for every interface.
bool is_any_interface(const std::string& text);

}  // namespace limb_ring::config
