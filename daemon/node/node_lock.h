#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "io/lock_file.h"

namespace limb_ring::host {

/// Another daemon holds the node; what() says which.
struct NodeHeld : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Holds a node for one daemon: the lock file DIRECTORY/ID.lock. Its text says who the holder is, and how to
/// start it again once it is dead: its pid in a line, then, each ended by a null since paths may have line ends,
/// program, working folder and the arguments. Also has a shared BSD lock of the folder, as tmpfiles.d(5) asks for: then
/// systemd-tmpfiles leaves what is in there, however old it is.
class NodeLock {
 public:
  /// Waits for 200 ms where somebody holds it, who may be ending.
  /// @throw NodeHeld "node 3 (left_knee) of ring r is held by pid 4711 (ringd)"; std::system_error naming
  ///        the file and what is wrong with it
  NodeLock(const std::string& directory, const std::string& ring, std::uint8_t id, const std::string& name);

  /// False where its file was removed, so that another daemon can have one of its own.
  bool is_in_place() const { return file_.is_in_place(); }

 private:
  std::shared_ptr<process::UniqueFd> folder_;  ///< one for all nodes of this process
  process::LockFile file_;                     ///< stays when this daemon ends: it says how to start it again
};

}  // namespace limb_ring::host
