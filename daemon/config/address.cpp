#include "config/address.h"

#include <arpa/inet.h>

#include <optional>

namespace limb_ring::config {
namespace {

std::optional<in_addr> ipv4(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1 ? std::optional(address) : std::nullopt;
}

std::optional<in6_addr> ipv6(const std::string& text) {
  in6_addr address{};
  return inet_pton(AF_INET6, text.c_str(), &address) == 1 ? std::optional(address) : std::nullopt;
}

/// ::ffff:1.2.3.4 is 1.2.3.4.
std::optional<in_addr> ipv4_within(const in6_addr& address) {
  if (!IN6_IS_ADDR_V4MAPPED(&address)) return std::nullopt;
  return in_addr{address.s6_addr32[3]};
}

bool is_ipv4_loopback(in_addr address) { return ntohl(address.s_addr) >> 24 == 127; }
bool is_ipv4_any(in_addr address) { return address.s_addr == htonl(INADDR_ANY); }

}  // namespace

bool is_address(const std::string& text) { return ipv4(text) || ipv6(text); }

bool is_loopback(const std::string& address) {
  if (const auto four = ipv4(address)) return is_ipv4_loopback(*four);
  const auto six = ipv6(address);
  if (!six) return false;
  const auto within = ipv4_within(*six);
  return within ? is_ipv4_loopback(*within) : IN6_IS_ADDR_LOOPBACK(&*six);
}

bool is_any_interface(const std::string& address) {
  if (const auto four = ipv4(address)) return is_ipv4_any(*four);
  const auto six = ipv6(address);
  if (!six) return false;
  const auto within = ipv4_within(*six);
  return within ? is_ipv4_any(*within) : IN6_IS_ADDR_UNSPECIFIED(&*six);
}

}  // namespace limb_ring::config
