#pragma once

#include <string>

namespace limb_ring::process {

/// A fresh folder below the system's temporary one, removed with all in it.
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
};

}  // namespace limb_ring::process
