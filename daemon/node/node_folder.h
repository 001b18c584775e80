#pragma once

#include <optional>
#include <string>

#include "config/ring_config.h"
#include "node/boot_record.h"
#include "node/node_lock.h"

namespace limb_ring::runtime {

/// The files of one node in its ring's runtime folder, except its sockets: the lock, which keeps other daemons off,
/// and the boot record.
class NodeFolder {
 public:
  /// @throw host::NodeHeld where another daemon holds the node, std::exception where it cannot be made
  NodeFolder(const config::RingConfig& ring, const config::NodeConfig& node);

  const std::string& path() const { return path_; }
  bool is_in_place() const { return lock_ && lock_->is_in_place(); }
  /// Makes them again after the folder was removed. @throw as the constructor
  void make_again();

  /// The first boot number of this process: see BootRecord::first().
  std::uint64_t first_boot() const;
  void note_boot(std::uint64_t boot) { boots_->note(boot); }

 private:
  const config::RingConfig& ring_;
  const config::NodeConfig& node_;
  std::string path_;
  std::optional<host::NodeLock> lock_;  ///< none where it could not be taken again
  std::optional<BootRecord> boots_;
};

}  // namespace limb_ring::runtime
