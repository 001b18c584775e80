#pragma once

#include <sys/stat.h>

#include <string>

namespace limb_ring::process {

/// There is a socket at that path, not a link to one: what was bound there, as far as can be seen.
inline bool is_socket(const std::string& path) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0 && S_ISSOCK(found.st_mode);
}

}  // namespace limb_ring::process
