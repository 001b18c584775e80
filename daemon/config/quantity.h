#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace limb_ring::config {

/// Numbers as people write them (ours), in a configuration and on a command line: "100ms", "10Mbit/s", "1e9".
/// One blank may separate number and unit. Returns nothing if the text is not such a quantity,
/// or beyond 64 bits.

/// Units: ns, us (or µs), ms, s. Rounded to whole nanoseconds.
std::optional<std::chrono::nanoseconds> parse_time(const std::string& text);
/// With the largest unit in which it is a whole number; 0 is "0s".
std::string format_time(std::chrono::nanoseconds time);
/// For people: with the largest unit that is not above it, "15.433244s" and "20ms". parse_time() reads it, too.
std::string time_text(std::chrono::nanoseconds time);

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

/// Only ASCII, whatever the locale says.
inline bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
/// Only digits, 1 to `most` of them: with up to 9, std::stoi() can read it.
bool are_digits(const std::string& text, std::size_t most = std::string::npos);

/// UTF-8 without control characters: can be printed, and written into JSON and XML as it is.
bool is_plain_text(const std::string& text);

/// Fit for one line of an error message, whatever was given: control characters are '?', and of what is long the first
/// 60 bytes are shown, and "...".
std::string printable(const std::string& text);

/// A configuration that is refused. what() reads
/// `FILE:LINE:COLUMN: entry 'timeouts.send': '12 parsec' is not a time; allowed: a time such as
/// 100ms, 1ms to 60s`; lines and columns count from 1. Several problems are a line each.
struct ConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What is wrong with one file, gathered so that a reader says all of it at once. (ours)
class Problems {
 public:
  static constexpr std::size_t kMost = 50;  ///< of further ones there is a last line

  /// Does that, and notes the ConfigError in which it ends.
  /// @return it came to its end
  template <typename Work>
  bool gather(Work&& work) {
    try {
      work();
      return true;
    } catch (const ConfigError& error) {
      add(error.what());
      return false;
    }
  }
  /// One problem or several, a line each; a line that is known already is not noted again. Empty: something failed
  /// only because of another problem, which somebody else says.
  void add(const std::string& lines) {
    failed_ = true;
    for (std::size_t at = 0; at < lines.size();) {
      const std::size_t end = std::min(lines.find('\n', at), lines.size());
      const std::string line = lines.substr(at, end - at);
      at = end + 1;
      if (std::find(lines_.begin(), lines_.end(), line) != lines_.end()) continue;
      if (lines_.size() < kMost) lines_.push_back(line);
      if (lines_.size() == kMost) lines_.back() = "There are more problems than these.";
    }
  }
  /// @throw ConfigError with everything noted, if there is anything
  void refuse_all() const {
    if (!failed_) return;
    std::string all;
    for (const std::string& line : lines_) all += (all.empty() ? "" : "\n") + line;
    throw ConfigError(all);
  }

 private:
  bool failed_ = false;
  std::vector<std::string> lines_;
};

/// Whether both are the same numeric IPv4 or IPv6 address, however written: ::1 is also 0:0:0:0:0:0:0:1. False if one
/// is not an address.

bool is_address(const std::string& text);
/// 127.0.0.0/8 and ::1: can be reached only from the same machine.
bool is_loopback(const std::string& text);
/// 0.0.0.0 and ::, which stand for every interface.
bool is_any_interface(const std::string& text);

}  // namespace limb_ring::config
