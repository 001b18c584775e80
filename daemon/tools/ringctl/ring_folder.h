#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/unique_fd.h"
#include "tools/ringctl/screen.h"

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

/// Ids of the nodes whose daemon has a socket in the ring's folder, answering or not, sorted.
std::vector<std::uint8_t> node_sockets(const std::string& ring);

/// Signals all daemons that run in a ring's folder.
void signal_daemons(const std::string& folder, int number);

/// Asks them to end, also those that are stopped.
void terminate_daemons(const std::string& folder);

/// Waits for the end of all daemons that run in a ring's folder, 3 s at most. @return true if all have ended
bool wait_until_gone(const std::string& folder, Progress& progress);

/// Removes the folder of a ring that has ended; not if a daemon lives, or has recorded what may tell why.
void tidy_folder(const std::string& ring);

/// ": Permission denied", ": belongs to user 1001 ..." if that folder is not this user's alone; empty if it is,
/// or is not there.
std::string why_unreadable(const std::string& folder);

/// Says on standard error what is wrong with files of a ring's folder that are not regular files
/// (live::unreadable_files).
void tell_unreadable(const std::string& folder);

/// Says on standard error why rings could be there and not be seen: whose folder all rings' folders are in.
void tell_unreadable_rings();

}  // namespace limb_ring::ringctl
