#include "app/ringctl/up_lock.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "app/ringctl/problems.h"
#include "limb_ring/ring_directory.h"
#include "live/lock_files.h"

namespace limb_ring::ringctl {

namespace {

namespace fs = std::filesystem;

/// What cannot be looked at, make_ring_directory() names.
bool is_there(const std::string& folder) {
  std::error_code error;
  return fs::exists(folder, error);
}

bool has_recordings(const std::string& folder) {
  std::error_code error;
  const fs::directory_iterator files(folder, error);
  return std::any_of(fs::begin(files), fs::end(files),
                     [](const fs::directory_entry& file) { return file.path().extension() == ".record"; });
}

}  // namespace

UpLock::UpLock(const std::string& ring, const std::string& host)
    : folder_is_new_(!is_there(ring_directory(ring))), folder_(make_ring_directory(ring)) {
  const std::string path = folder_ + (host.empty() ? "/up" : "/up-" + host) + ".lock";
  file_ = process::LockFile::take(path);
  if (!file_) throw NotDone("ring " + ring + " is being started already, by " + process::lock_holder(path));
  file_->write(std::to_string(::getpid()) + '\n');
}

UpLock::~UpLock() {
  if (file_ && folder_is_new_ && live::held_nodes(folder_).empty() && !has_recordings(folder_))
    live::remove_leftovers(folder_);
  release();
}

void UpLock::release() {
  if (!file_) return;
  file_->remove();
  file_.reset();
  ::rmdir(folder_.c_str());  // stays where a daemon has left something in it
}

}  // namespace limb_ring::ringctl
