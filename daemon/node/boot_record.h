#pragma once

#include <cstdint>
#include <string>

#include "io/unique_fd.h"

namespace limb_ring::runtime {

/// The last boot number of a node, kept in the ring's folder beside its lock (`ID.boot`, 8 bytes, big-endian), so that
/// a new process continues where the previous one ended, even after kill -9. A packet carries two bits of its
/// source's boot number. As the new process counts these on by one, they tell the two processes apart before any
/// hello is heard. (ours, protocol.md section 4.8)
class BootRecord {
 public:
  /// Opens or creates the file. If it holds no number, the previous one is unknown. The same if it cannot be opened,
  /// which is logged as a warning.
  BootRecord(const std::string& directory, std::uint8_t id);

  /// The first boot number of a new process: nanoseconds since 1970, or the previous number + 1 if that is higher. Its
  /// two low bits are always those of the previous number + 1, if that is known.
  std::uint64_t first(std::uint64_t now_ns) const;
  /// The node's current boot number. Written to the file only if it has changed.
  void note(std::uint64_t boot) {
    if (boot != last_) write(boot);
  }

 private:
  void write(std::uint64_t boot);

  process::UniqueFd fd_;
  std::uint64_t last_ = 0;  ///< 0: unknown
};

}  // namespace limb_ring::runtime
