#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace limb_ring::config {

/// Numbers as people write them (ours), in a configuration and on a command line: "100ms", "10Mbit/s", "1e9".
/// One blank may part number and unit. Nothing is returned where the text is no such quantity,
/// or beyond 64 bits.

/// Units: ns, us (or µs), ms, s. Rounded to whole nanoseconds.
std::optional<std::chrono::nanoseconds> parse_time(const std::string& text);
/// With the largest unit in which it is a whole number; 0 is "0s".
std::string format_time(std::chrono::nanoseconds time);

/// Units: bit/s, kbit/s, Mbit/s, Gbit/s (powers of 1000), also Mbps, MBit/s or M alone; a plain number is bit/s,
/// and "unlimited" is 0. MB/s is refused: that would be bytes.
std::optional<std::uint64_t> parse_rate(const std::string& text);
std::string format_rate(std::uint64_t bits_per_second);

/// A plain decimal number with optional sign, fraction and exponent; finite, whatever the locale.
std::optional<double> parse_real(const std::string& text);
/// The shortest form up to 6 digits.
std::string format_real(double value);

/// A whole number in decimal digits with optional sign; without one also 1e6, 64k, 1M, 2G (powers of 1000).
std::optional<std::int64_t> parse_integer(const std::string& text);

}  // namespace limb_ring::config
