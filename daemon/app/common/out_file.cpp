#include "app/common/out_file.h"

#include <cerrno>
#include <cstring>

namespace limb_ring::app {

std::string open_for_writing(std::ofstream& file, const std::string& path) {
  file.open(path, std::ios::binary);
  return file ? "" : path + ": cannot be written: " + std::strerror(errno);
}

// Streams do not keep the reason: writing once more fails for the same one.
std::string finish_writing(std::ostream& out, const std::string& path) {
  if (out.flush()) return "";
  out.clear();
  errno = 0;
  out.put('\n').flush();
  return path + ": not all could be written" + (errno != 0 ? std::string(": ") + std::strerror(errno) : "");
}

}  // namespace limb_ring::app
