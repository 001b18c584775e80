#pragma once

#include <optional>
#include <string>

#include "io/lock_file.h"

namespace limb_ring::process {

/// A fresh folder below the system's temporary one, removed with all in it. One whose process was killed is removed by
/// the next process that makes one for the same purpose: nobody holds the lock in it any more.
class TemporaryFolder {
 public:
  /// @param purpose a word in its name, for people who find one that was left behind: limb_ring_PURPOSE_XXXXXX
  /// @throw std::system_error where none can be made
  explicit TemporaryFolder(const std::string& purpose);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string file(const std::string& name) const { return path_ + '/' + name; }

 private:
  std::string path_;
  std::optional<LockFile> lock_;
};

}  // namespace limb_ring::process
