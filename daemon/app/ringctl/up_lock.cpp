#include "app/ringctl/up_lock.h"

#include <unistd.h>

#include "app/ringctl/problems.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::ringctl {

UpLock::UpLock(const std::string& ring, const std::string& host) : folder_(make_ring_directory(ring)) {
  const std::string path = folder_ + (host.empty() ? "/up" : "/up-" + host) + ".lock";
  file_ = process::LockFile::take(path);
  if (!file_) throw NotDone("ring " + ring + " is being started already, by " + process::lock_holder(path));
  file_->write(std::to_string(::getpid()) + '\n');
}

void UpLock::release() {
  if (!file_) return;
  file_->remove();
  file_.reset();
  ::rmdir(folder_.c_str());  // stays where a daemon has left something in it
}

}  // namespace limb_ring::ringctl
