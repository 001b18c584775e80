#pragma once

#include <optional>
#include <string>

#include "process/lock_file.h"

namespace limb_ring::ringctl {

/// Of two `ringctl up` of one ring, or of one host's part of it, one starts it: a lock in the ring's folder from before
/// it looks whether the ring runs until the ring is closed.
class UpLock {
 public:
  /// @param host whose part is started; empty: all of the ring
  /// @throw NotDone with the pid of the other one
  UpLock(const std::string& ring, const std::string& host);
  ~UpLock() { release(); }
  UpLock(const UpLock&) = delete;
  UpLock& operator=(const UpLock&) = delete;

  /// The ring is closed, or will not be. Leaves nothing behind.
  void release();

 private:
  std::string folder_;
  std::optional<process::LockFile> file_;
};

}  // namespace limb_ring::ringctl
