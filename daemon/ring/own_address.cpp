#include "ring/own_address.h"

#include <netdb.h>
#include <sys/socket.h>

#include <memory>

#include "io/unique_fd.h"

namespace limb_ring::live {

// Tries to bind rather than listing interfaces: no interface has 127.0.0.2, and yet it is this machine's own.
bool is_own_address(const std::string& address) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_PASSIVE;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.c_str(), nullptr, &hints, &found) != 0) return false;
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> freed(found, ::freeaddrinfo);
  const process::UniqueFd socket(::socket(found->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  return socket.valid() && ::bind(socket.get(), found->ai_addr, found->ai_addrlen) == 0;
}

}  // namespace limb_ring::live
