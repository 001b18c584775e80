#include "io/temporary_folder.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "io/throw_errno.h"

namespace limb_ring::process {

namespace fs = std::filesystem;

namespace {

constexpr const char* kRandomPart = "XXXXXX";

std::string lock_in(const std::string& folder) { return folder + "/owner.lock"; }

bool is_ours(const std::string& folder) {
  struct stat status {};
  return ::lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == ::geteuid();
}

/// @return nothing where somebody has taken the folder for one that was left behind
std::optional<LockFile> locked(const std::string& folder) try {
  return LockFile::take(lock_in(folder));
} catch (const std::system_error& problem) {
  if (problem.code() == std::errc::no_such_file_or_directory) return std::nullopt;
  ::rmdir(folder.c_str());
  throw;
}

/// The lock last: whoever is killed in between leaves a folder that the next one removes.
void remove_folder(const std::string& folder) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (it->path() != lock_in(folder)) fs::remove_all(it->path(), ignored);
  }
  ::unlink(lock_in(folder).c_str());
  ::rmdir(folder.c_str());
}

// One without the file is just being made, and then made again, or what is left of one.
void remove_if_left(const std::string& folder) try {
  if (!is_ours(folder)) return;
  std::error_code ignored;
  if (!fs::exists(lock_in(folder), ignored)) {
    ::rmdir(folder.c_str());
  } else if (const auto lock = LockFile::take(lock_in(folder))) {
    remove_folder(folder);
  }
} catch (const std::system_error&) {  // it is gone, or stays
}

void remove_those_left(const std::string& prefix) {
  std::error_code error;
  for (fs::directory_iterator it(fs::path(prefix).parent_path(), error), end; !error && it != end; it.increment(error))
    if (it->path().string().rfind(prefix, 0) == 0) remove_if_left(it->path().string());
}

}  // namespace

TemporaryFolder::TemporaryFolder(const std::string& purpose) {
  const std::string prefix = (fs::temp_directory_path() / ("limb_ring_" + purpose + '_')).string();
  remove_those_left(prefix);
  while (!lock_) {
    path_ = prefix + kRandomPart;
    if (::mkdtemp(path_.data()) == nullptr) throw_errno("cannot make a folder " + path_);
    lock_ = locked(path_);
  }
}

TemporaryFolder::~TemporaryFolder() { remove_folder(path_); }

}  // namespace limb_ring::process
