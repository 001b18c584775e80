#include "io/own_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

namespace limb_ring::process {

bool empty_long_log(const std::string& folder, off_t most) {
  namespace fs = std::filesystem;
  struct stat info {};
  if (::fstat(STDERR_FILENO, &info) != 0 || !S_ISREG(info.st_mode) || info.st_size <= most) return false;
  // Who does not append would go on where it was, behind a hole.
  if ((::fcntl(STDERR_FILENO, F_GETFL) & O_APPEND) == 0) return false;
  std::error_code error;
  const fs::path path = fs::read_symlink("/proc/self/fd/2", error);
  return !error && fs::equivalent(path.parent_path(), folder, error) && ::ftruncate(STDERR_FILENO, 0) == 0;
}

}  // namespace limb_ring::process
