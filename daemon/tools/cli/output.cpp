#include "tools/cli/output.h"

#include <cerrno>
#include <cstring>
#include <iostream>

namespace limb_ring::cli {

// Streams do not keep the reason: writing once more fails for the same one.
std::string finish_writing(std::ostream& out, const std::string& path) {
  if (out.flush()) return "";
  out.clear();
  errno = 0;
  out.put('\n').flush();
  return path + ": not all could be written" + (errno != 0 ? std::string(": ") + std::strerror(errno) : "");
}

int code_with_output(const std::string& program, int code) {
  if (code != 0) return code;
  const std::string problem = finish_writing(std::cout, "standard output");
  if (problem.empty()) return code;
  std::cerr << program << ": " << problem << '\n';
  return 1;
}

}  // namespace limb_ring::cli
