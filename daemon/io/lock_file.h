#pragma once

#include <optional>
#include <string>

#include "io/unique_fd.h"

namespace limb_ring::process {

/// A file that one process at a time has locked (F_OFD_SETLK), the first line of which says who: its pid. The kernel
/// frees it when the process ends, however it ends; children do not inherit it. Others can query the lock without
/// taking it, so that a process that only asks is never mistaken for a holder.
class LockFile {
 public:
  /// @return nothing where another process has it
  /// @throw std::runtime_error naming the file and what is wrong with it; std::system_error where the system says so
  static std::optional<LockFile> take(const std::string& path);

  /// Makes this its text. @throw std::system_error
  void write(const std::string& text) const;
  /// False where the file was removed, so that another process can lock one of its own.
  bool is_in_place() const;
  /// Removes the file, unless it is another's by now.
  void remove() const;

 private:
  LockFile(std::string path, UniqueFd file) : path_(std::move(path)), file_(std::move(file)) {}

  std::string path_;
  UniqueFd file_;
};

/// "pid 4711 (ringd)": who holds the lock file there, as far as can be known.
std::string lock_holder(const std::string& path);

}  // namespace limb_ring::process
