#include "app/ringctl/up_lock.h"

#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "app/ringctl/problems.h"
#include "app/ringctl/ring_folder.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::ringctl {

namespace {

/// What cannot be looked at, make_ring_directory() names.
bool is_there(const std::string& folder) {
  std::error_code error;
  return std::filesystem::exists(folder, error);
}

}  // namespace

UpLock::UpLock(const std::string& ring, const std::string& host)
    : ring_(ring), folder_is_new_(!is_there(ring_directory(ring))), folder_(make_ring_directory(ring)) {
  const std::string path = folder_ + (host.empty() ? "/up" : "/up-" + host) + ".lock";
  file_ = process::LockFile::take(path);
  if (!file_) throw NotDone("ring " + ring + " is being started already, by " + process::lock_holder(path));
  file_->write(std::to_string(::getpid()) + '\n');
}

UpLock::~UpLock() {
  if (file_ && folder_is_new_) tidy_folder(ring_);
  release();
}

void UpLock::release() {
  if (!file_) return;
  file_->remove();
  file_.reset();
  ::rmdir(folder_.c_str());  // stays where a daemon has left something in it
}

}  // namespace limb_ring::ringctl
