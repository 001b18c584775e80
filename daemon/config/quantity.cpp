#include "config/quantity.h"

#include <array>
#include <charconv>
#include <cmath>
#include <locale>
#include <sstream>

namespace limb_ring::config {
namespace {

struct Unit {
  const char* name;
  std::uint64_t size;
};

// Largest first: formatting takes the first that divides.
constexpr std::array<Unit, 4> kTimeUnits{
    {{"s", 1000000000}, {"ms", 1000000}, {"us", 1000}, {"ns", 1}}};
constexpr std::array<Unit, 4> kRateUnits{
    {{"Gbit/s", 1000000000}, {"Mbit/s", 1000000}, {"kbit/s", 1000}, {"bit/s", 1}}};

/// Digits with at most one point among them: no sign, no exponent, so that units may follow.
std::optional<long double> parse_decimal(const std::string& text) {
  long double value = 0, place = 0;
  bool digits = false;
  for (const char c : text) {
    if (c == '.' && place == 0) {
      place = 1;
    } else if (c >= '0' && c <= '9') {
      digits = true;
      value = value * 10 + (c - '0');
      place *= 10;
    } else {
      return std::nullopt;
    }
  }
  if (!digits) return std::nullopt;
  return place > 1 ? value / place : value;
}

std::optional<std::uint64_t> scale(long double number, std::uint64_t unit) {
  const long double whole = std::round(number * static_cast<long double>(unit));
  if (!(whole < 9.2e18L)) return std::nullopt;
  return static_cast<std::uint64_t>(whole);
}

std::optional<std::uint64_t> parse_quantity(const std::string& text,
                                            const std::array<Unit, 4>& units) {
  const std::size_t end = text.find_first_not_of("0123456789.");
  if (end == std::string::npos) return std::nullopt;
  const std::string unit = text.substr(text[end] == ' ' ? end + 1 : end);
  const auto number = parse_decimal(text.substr(0, end));
  for (const Unit& known : units)
    if (number && unit == known.name) return scale(*number, known.size);
  return std::nullopt;
}

std::string format_quantity(std::uint64_t value, const std::array<Unit, 4>& units) {
  std::size_t i = 0;
  while (value % units[i].size != 0) ++i;
  return std::to_string(value / units[i].size) + units[i].name;
}

}  // namespace

std::optional<std::chrono::nanoseconds> parse_time(const std::string& text) {
  const auto count = parse_quantity(text, kTimeUnits);
  if (!count) return std::nullopt;
  return std::chrono::nanoseconds(static_cast<std::int64_t>(*count));
}

std::string format_time(std::chrono::nanoseconds time) {
  return format_quantity(static_cast<std::uint64_t>(time.count()), kTimeUnits);
}

std::optional<std::uint64_t> parse_rate(const std::string& text) {
  if (text == "unlimited") return 0;
  if (const auto plain = parse_decimal(text)) return scale(*plain, 1);
  return parse_quantity(text, kRateUnits);
}

std::string format_rate(std::uint64_t bits_per_second) {
  return bits_per_second == 0 ? "unlimited" : format_quantity(bits_per_second, kRateUnits);
}

std::optional<double> parse_real(const std::string& text) {
  if (text.find_first_not_of("0123456789+-.eE") != std::string::npos) return std::nullopt;
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  double value = 0;
  if (!(in >> value) || in.peek() != std::istringstream::traits_type::eof()) return std::nullopt;
  return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

std::string format_real(double value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << value;
  return out.str();
}

std::optional<std::int64_t> parse_integer(const std::string& text) {
  std::int64_t value = 0;
  if (text.rfind("+-", 0) == 0) return std::nullopt;
  const char* begin = text.data() + (text.rfind('+', 0) == 0 ? 1 : 0);  // from_chars takes no '+'
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace limb_ring::config
