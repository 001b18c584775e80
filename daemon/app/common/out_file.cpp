#include "app/common/out_file.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>

namespace limb_ring::app {

std::string open_for_writing(std::ofstream& file, const std::string& path) {
  file.open(path, std::ios::binary);
  return file ? "" : path + ": cannot be written: " + std::strerror(errno);
}

bool is_same_file(const std::string& one, const std::string& other) {
  std::error_code missing;
  return std::filesystem::equivalent(one, other, missing);
}

// Streams do not keep the reason: writing once more fails for the same one.
std::string finish_writing(std::ostream& out, const std::string& path) {
  if (out.flush()) return "";
  out.clear();
  errno = 0;
  out.put('\n').flush();
  return path + ": not all could be written" + (errno != 0 ? std::string(": ") + std::strerror(errno) : "");
}

bool is_output_read() {
  pollfd output{STDOUT_FILENO, 0, 0};
  return ::poll(&output, 1, 0) <= 0 || (output.revents & POLLERR) == 0;
}

int code_with_output(const std::string& program, int code) {
  if (code != 0) return code;
  const std::string problem = finish_writing(std::cout, "standard output");
  if (problem.empty()) return code;
  std::cerr << program << ": " << problem << '\n';
  return 1;
}

}  // namespace limb_ring::app
