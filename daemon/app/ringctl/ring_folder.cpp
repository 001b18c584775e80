#include "app/ringctl/ring_folder.h"

#include <fcntl.h>
#include <sys/stat.h>

#include "limb_ring/ring_directory.h"
#include "live/lock_files.h"

namespace limb_ring::ringctl {

RingFolder::RingFolder(const std::string& ring)
    : path_(ring_directory(ring)), opened_(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {}

// The folder stays where somebody has put a file into it.
bool RingFolder::is_gone() const {
  struct stat folder {};
  if (::fstat(opened_.get(), &folder) != 0 || folder.st_nlink == 0) return true;
  return live::known_nodes(path_).empty();
}

}  // namespace limb_ring::ringctl
