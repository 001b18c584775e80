#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

/// What `ringctl view` serves, and to whom.
struct ViewOptions {
  std::string ring;
  std::string address = "127.0.0.1";  ///< to listen at, IPv4 or IPv6 in numbers
  std::uint16_t port = 0;             ///< 0: any that is free
  bool control = false;               ///< the page may break and mend
  std::string folder;                 ///< of the page's files
};

/// Serves the page for a running ring by HTTP, until SIGINT or SIGTERM. (ours)
///
/// The address that is printed holds a token of 128 random bits; without it nothing is given. Requests are bounded in
/// size and time, clients in number; one that reads too slowly is dropped. Requests of other origins, and those for a
/// host that is a name but localhost (DNS rebinding), are refused. Without `control` nothing can be changed. What the
/// page orders is done by a ringctl of its own, so it is what the same words do on a command line.
/// @return an ExitCode. @throw UsageError where the address cannot be had, or the page's files are not there
int serve_view(const ViewOptions& options);

/// The command line for an order of the page, such as ["fault", "hang", "left_knee"], without "ringctl --ring RING".
/// @throw UsageError where that is none of those that a page may give, or a word is no plain one
std::vector<std::string> ordered_words(const std::string& json);

/// Whether requests for this Host are answered: numbers or localhost, at this port.
bool is_own_host(const std::string& host, std::uint16_t port);

/// Same length and bytes, in a time that does not tell where they differ.
bool is_same_secret(const std::string& one, const std::string& other);

}  // namespace limb_ring::ringctl
