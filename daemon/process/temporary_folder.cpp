#include "process/temporary_folder.h"

#include <stdlib.h>

#include <filesystem>

#include "process/throw_errno.h"

namespace limb_ring::process {

TemporaryFolder::TemporaryFolder(const std::string& purpose)
    : path_((std::filesystem::temp_directory_path() / ("limb_ring_" + purpose + "_XXXXXX")).string()) {
  if (::mkdtemp(path_.data()) == nullptr) throw_errno("cannot make a folder " + path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace limb_ring::process
