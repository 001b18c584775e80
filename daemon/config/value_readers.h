#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "config/entry.h"

namespace limb_ring::config {

/// What one option accepts; `allowed` puts it in words for errors and documentation alike.
struct IntegerRange {
  std::int64_t least, most;
};
struct RealRange {
  double least, most;
  const char* unit;
};
/// Of a joint, as far as packets carry it (payload/joint_state.h).
constexpr RealRange kPositions{-2147, 2147, "rad or m"}, kVelocities{0.001, 2147, "rad/s or m/s"},
    kEfforts{0.001, 2147, "N m or N"};
struct TimeRange {
  std::chrono::nanoseconds least, most;
  std::chrono::nanoseconds grain;  ///< whole multiples of this
};
constexpr IntegerRange kReceiveBuffers{1, 65536};
std::string allowed(const IntegerRange& range);
std::string allowed(const RealRange& range);
std::string allowed(const TimeRange& range);

extern const char* const kAllowedRates;
extern const char* const kAllowedCommands;

/// Each reads one value. @throw ConfigError where it is not what is allowed.
std::int64_t read_integer(const Entry& entry, const IntegerRange& range);
double read_real(const Entry& entry, const RealRange& range);
std::chrono::nanoseconds read_time(const Entry& entry, const TimeRange& range);
/// bit/s; 0 where `unlimited`.
std::uint64_t read_rate(const Entry& entry);
bool read_flag(const Entry& entry);
/// @return index into `words`.
std::size_t read_choice(const Entry& entry, const std::vector<std::string>& words);
std::string read_name(const Entry& entry, bool (*fits)(const std::string&), const char* rule);
/// Program and arguments: a list of 1 to 64 words, the first not empty.
std::vector<std::string> read_command(const Entry& entry);
/// An IPv4 or IPv6 address in numbers, of one interface.
std::string read_address(const Entry& entry);
/// A node of this ring, by id or name. `also`: what else the option takes, for the error.
std::uint8_t read_node(const Entry& entry, const std::string& also = "");

}  // namespace limb_ring::config
