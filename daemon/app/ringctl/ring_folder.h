#pragma once

#include <string>

#include "process/unique_fd.h"

namespace limb_ring::ringctl {

/// The folder of a running ring, held open, so that it is not mistaken for one that is made anew in its place.
class RingFolder {
 public:
  explicit RingFolder(const std::string& ring);

  const std::string& path() const { return path_; }
  /// The ring was taken down: 'ringctl down' removes the folder. A ring of which all daemons have died is not gone.
  bool is_gone() const;

 private:
  std::string path_;
  process::UniqueFd opened_;
};

}  // namespace limb_ring::ringctl
