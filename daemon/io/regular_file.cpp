#include "io/regular_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace limb_ring::process {
namespace {

/// Empty where it is a regular file, or nothing is there.
std::string other_kind(const std::string& path) {
  struct stat found {};
  if (::lstat(path.c_str(), &found) != 0 || S_ISREG(found.st_mode)) return "";
  const mode_t mode = found.st_mode;
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISLNK(mode)) return "a symbolic link";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

}  // namespace

UniqueFd open_regular(const std::string& path, int flags) {
  UniqueFd file(::open(path.c_str(), flags | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW, 0600));
  struct stat found {};
  if (!file.valid() || (::fstat(file.get(), &found) == 0 && S_ISREG(found.st_mode))) return file;
  file.reset();
  errno = EINVAL;
  return file;
}

std::string why_not_regular(const std::string& path) {
  const std::string kind = other_kind(path);
  return kind.empty() ? "" : path + " is " + kind + ", not a regular file";
}

std::string why_not_opened(const std::string& path) {
  const int error = errno;
  const std::string kind = other_kind(path);
  return kind.empty() ? std::strerror(error) : "it is " + kind + ", not a regular file; remove it";
}

std::string text_of(const UniqueFd& file) {
  std::string text;
  std::array<char, 4096> part{};
  for (ssize_t got = 0; (got = ::pread(file.get(), part.data(), part.size(), static_cast<off_t>(text.size()))) > 0;)
    text.append(part.data(), static_cast<std::size_t>(got));
  return text;
}

std::string text_of_regular(const std::string& path) {
  const UniqueFd file = open_regular(path);
  return file.valid() ? text_of(file) : "";
}

}  // namespace limb_ring::process
