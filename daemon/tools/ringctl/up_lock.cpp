#include "tools/ringctl/up_lock.h"

#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "limb_ring/ring_directory.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/ring_folder.h"

namespace limb_ring::ringctl {

namespace {

/// What cannot be looked at, make_ring_directory() names.
bool is_there(const std::string& folder) {
  std::error_code error;
  return std::filesystem::exists(folder, error);
}

/// 'ringctl down' may remove the folder at any time before the lock is had. @return nothing where another one has it
std::optional<process::LockFile> take_in_folder(const std::string& ring, const std::string& host) {
  for (;;) {
    try {
      return process::LockFile::take(up_lock(make_ring_directory(ring), host));
    } catch (const std::system_error& problem) {
      if (problem.code() != std::errc::no_such_file_or_directory) throw;
    }
  }
}

}  // namespace

std::string up_lock(const std::string& folder, const std::string& host) {
  return folder + (host.empty() ? "/up" : "/up-" + host) + ".lock";
}

UpLock::UpLock(const std::string& ring, const std::string& host)
    : ring_(ring),
      folder_is_new_(!is_there(ring_directory(ring))),
      folder_(make_ring_directory(ring)),
      file_(take_in_folder(ring, host)) {
  if (!file_)
    throw NotDone("ring " + ring + " is being started already, by " + process::lock_holder(up_lock(folder_, host)));
  file_->write(std::to_string(::getpid()) + '\n');
}

UpLock::~UpLock() {
  try {
    if (file_ && folder_is_new_) tidy_folder(ring_);
  } catch (const std::system_error&) {  // what cannot be looked at, for want of descriptors, stays
  }
  release();
}

void UpLock::release() {
  if (!file_) return;
  file_->remove();
  file_.reset();
  ::rmdir(folder_.c_str());  // stays where a daemon has left something in it
}

}  // namespace limb_ring::ringctl
