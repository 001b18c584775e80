#pragma once

#include <map>
#include <optional>
#include <string>

#include "io/temporary_folder.h"

namespace limb_ring::live {

/// A fresh XDG_RUNTIME_DIR of this process and those it starts, so that nothing of the user's is
/// touched. Removed with everything in it; the environment is then as before.
class PrivateFolder {
 public:
  /// @throw std::system_error where none can be made
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::string& path() const { return folder_.path(); }

 private:
  void replace(const std::string& name, const char* value);

  process::TemporaryFolder folder_{"private"};
  std::map<std::string, std::optional<std::string>> before_;
};

}  // namespace limb_ring::live
