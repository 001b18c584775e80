#include "config/quantity.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <boost/locale/utf.hpp>
#include <charconv>
#include <cmath>
#include <locale>
#include <optional>
#include <sstream>

namespace limb_ring::config {
namespace {

struct Unit {
  const char* name;
  std::uint64_t size;
};

// Largest first: formatting takes the first that divides.
constexpr std::array<Unit, 4> kTimeUnits{{{"s", 1000000000}, {"ms", 1000000}, {"us", 1000}, {"ns", 1}}};
constexpr std::array<Unit, 4> kRateUnits{{{"Gbit/s", 1000000000}, {"Mbit/s", 1000000}, {"kbit/s", 1000}, {"bit/s", 1}}};

struct Scaled {
  long double number = 0;
  std::string unit;  ///< what stands behind it, without the blank between
};

/// End of an exponent that begins at `at`; `at` if there is none, since a unit may begin with an e.
std::size_t end_of_exponent(const std::string& text, std::size_t at) {
  if (at >= text.size() || (text[at] != 'e' && text[at] != 'E')) return at;
  std::size_t end = at + 1;
  if (end < text.size() && (text[end] == '+' || text[end] == '-')) ++end;
  if (end >= text.size() || !is_digit(text[end])) return at;
  while (end < text.size() && is_digit(text[end])) ++end;
  return end;
}

/// Digits with at most one point among them and perhaps an exponent, no sign, then a unit.
std::optional<Scaled> split(const std::string& text) {
  const std::size_t mantissa = std::min(text.find_first_not_of("0123456789."), text.size());
  const std::size_t end = end_of_exponent(text, mantissa);
  const auto number = parse_real(text.substr(0, end));
  if (!number || mantissa == 0) return std::nullopt;
  const std::size_t unit = end < text.size() && text[end] == ' ' ? end + 1 : end;
  if (unit != end && unit == text.size()) return std::nullopt;  // a blank at the end
  std::istringstream in(text.substr(0, end));
  in.imbue(std::locale::classic());
  Scaled scaled;
  in >> scaled.number;
  scaled.unit = text.substr(unit);
  return scaled;
}

std::optional<std::uint64_t> scale(long double number, long double unit) {
  const long double whole = std::round(number * unit);
  if (!(whole < 9.2e18L)) return std::nullopt;
  return static_cast<std::uint64_t>(whole);
}

/// Of k, M, G, T, as people write them; 0 for another.
long double prefix_of(char c) {
  switch (c) {
    case 'k':
    case 'K':
      return 1e3L;
    case 'm':
    case 'M':
      return 1e6L;
    case 'g':
    case 'G':
      return 1e9L;
    case 't':
    case 'T':
      return 1e12L;
    default:
      return 0;
  }
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

/// Bits in a second: bit/s, bps, with a prefix or the prefix alone; 0 for another. 10MB/s would be bytes: a b that
/// stands for bytes is not taken for bits.
long double rate_unit(const std::string& unit) {
  const long double prefix = unit.empty() ? 0 : prefix_of(unit[0]);
  const std::string rest = prefix == 0 ? unit : unit.substr(1);
  if (rest.rfind('B', 0) == 0 && lower(rest).rfind("bit", 0) != 0) return 0;
  for (const char* known : {"", "bit/s", "bits/s", "bit", "bps", "b/s"})
    if (lower(rest) == known) return prefix == 0 ? 1 : prefix;
  return 0;
}

std::string format_quantity(std::uint64_t value, const std::array<Unit, 4>& units) {
  std::size_t i = 0;
  while (value % units[i].size != 0) ++i;
  return std::to_string(value / units[i].size) + units[i].name;
}

}  // namespace

std::optional<std::chrono::nanoseconds> parse_time(const std::string& text) {
  const auto scaled = split(text);
  if (!scaled) return std::nullopt;
  const std::string unit = scaled->unit == "µs" ? "us" : scaled->unit;
  for (const Unit& known : kTimeUnits) {
    if (unit != known.name) continue;
    const auto count = scale(scaled->number, static_cast<long double>(known.size));
    if (!count) return std::nullopt;
    return std::chrono::nanoseconds(static_cast<std::int64_t>(*count));
  }
  return std::nullopt;
}

std::string format_time(std::chrono::nanoseconds time) {
  if (time.count() < 0) return '-' + format_quantity(-static_cast<std::uint64_t>(time.count()), kTimeUnits);
  return format_quantity(static_cast<std::uint64_t>(time.count()), kTimeUnits);
}

std::string time_text(std::chrono::nanoseconds time) {
  const std::string exact = format_time(time);
  const auto count = static_cast<std::uint64_t>(time.count());
  const auto unit =
      std::find_if(kTimeUnits.begin(), kTimeUnits.end(), [&](const Unit& known) { return known.size <= count; });
  if (time.count() <= 0 || count % unit->size == 0) return exact;
  std::string behind = std::to_string(unit->size + count % unit->size).substr(1);  // with its leading zeros
  behind.erase(behind.find_last_not_of('0') + 1);
  return std::to_string(count / unit->size) + '.' + behind + unit->name;
}

std::optional<std::uint64_t> parse_rate(const std::string& text) {
  if (text == "unlimited") return 0;
  const auto scaled = split(text);
  const long double unit = scaled ? rate_unit(scaled->unit) : 0;
  return unit == 0 ? std::nullopt : scale(scaled->number, unit);
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

namespace {

std::optional<std::int64_t> plain_integer(const std::string& text) {
  std::int64_t value = 0;
  if (text.rfind("+-", 0) == 0) return std::nullopt;
  const char* begin = text.data() + (text.rfind('+', 0) == 0 ? 1 : 0);  // from_chars takes no '+'
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace

std::optional<std::int64_t> parse_integer(const std::string& text) {
  if (const auto plain = plain_integer(text)) return plain;
  const auto scaled = split(text);
  if (!scaled || scaled->unit.size() > 1) return std::nullopt;
  // Not m: some read it as milli, others as million.
  const bool prefix = !scaled->unit.empty() && scaled->unit != "m";
  const bool exponent = scaled->unit.empty() && text.find_first_of("eE") != std::string::npos;
  const long double unit = prefix ? prefix_of(scaled->unit[0]) : exponent ? 1 : 0;
  const long double value = scaled->number * unit;
  if (unit == 0 || !(value < 9.2e18L) || value != std::floor(value)) return std::nullopt;
  return static_cast<std::int64_t>(value);
}

bool are_digits(const std::string& text, std::size_t most) {
  return !text.empty() && text.size() <= most && std::all_of(text.begin(), text.end(), is_digit);
}

bool is_plain_text(const std::string& text) {
  namespace utf = boost::locale::utf;
  for (auto at = text.begin(); at != text.end();) {
    const utf::code_point character = utf::utf_traits<char>::decode(at, text.end());
    const bool control = character < ' ' || (character >= 0x7f && character < 0xa0);
    if (!utf::is_valid_codepoint(character) || control) return false;
  }
  return true;
}

std::string printable(const std::string& text) {
  std::size_t end = std::min<std::size_t>(text.size(), 60);
  const auto goes_on = [&text](std::size_t at) { return (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80; };
  while (end > 0 && end < text.size() && goes_on(end)) --end;  // no character is cut in two
  std::string shown = text.substr(0, end);
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7F) c = '?';
  return end < text.size() ? shown + "..." : shown;
}

namespace {

/// An IPv4 address as ::ffff:1.2.3.4, so that it is one address however it is written.
std::optional<in6_addr> in_numbers(const std::string& text) {
  in6_addr address{};
  if (inet_pton(AF_INET6, text.c_str(), &address) == 1) return address;
  address.s6_addr[10] = address.s6_addr[11] = 0xFF;
  if (inet_pton(AF_INET, text.c_str(), &address.s6_addr[12]) == 1) return address;
  return std::nullopt;
}

}  // namespace

bool is_address(const std::string& text) { return in_numbers(text).has_value(); }

bool is_loopback(const std::string& text) {
  const auto address = in_numbers(text);
  if (!address) return false;
  return IN6_IS_ADDR_V4MAPPED(&*address) ? address->s6_addr[12] == 127 : IN6_IS_ADDR_LOOPBACK(&*address);
}

bool is_any_interface(const std::string& text) {
  const auto address = in_numbers(text);
  if (!address) return false;
  return IN6_IS_ADDR_V4MAPPED(&*address) ? address->s6_addr32[3] == 0 : IN6_IS_ADDR_UNSPECIFIED(&*address);
}

}  // namespace limb_ring::config
