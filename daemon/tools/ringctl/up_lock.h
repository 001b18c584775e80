#pragma once

#include <optional>
#include <string>

#include "io/lock_file.h"

namespace limb_ring::ringctl {

/// Path of the lock in a ring's folder. @param host whose part is started; empty: all of the ring
std::string up_lock(const std::string& folder, const std::string& host = {});

/// Of two `ringctl up` of one ring, or of one host's part of it, one starts it: a lock in the ring's folder from before
/// it looks whether the ring runs until the ring is closed.
class UpLock {
 public:
  /// @param host whose part is started; empty: all of the ring
  /// Where 'ringctl down' has just this lock, to tidy the folder, it comes after that. @throw NotDone with the pid of
  /// the other one
  UpLock(const std::string& ring, const std::string& host);
  /// Where the ring has not come up, and its folder was made for it, that goes, too: a failed start leaves nothing. It
  /// stays where a daemon lives, or has recorded what may tell why.
  ~UpLock();
  UpLock(const UpLock&) = delete;
  UpLock& operator=(const UpLock&) = delete;

  /// The ring is closed, or was taken down. Leaves nothing of its own behind.
  void release();

 private:
  std::string ring_;
  bool folder_is_new_;
  std::string folder_;
  std::optional<process::LockFile> file_;
};

}  // namespace limb_ring::ringctl
