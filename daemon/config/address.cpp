#include "config/address.h"

#include <arpa/inet.h>

#include <optional>

namespace limb_ring::config {
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
