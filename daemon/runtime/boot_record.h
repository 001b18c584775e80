#pragma once

#include <cstdint>
#include <string>

namespace limb_ring::runtime {

/// The last boot number of a node, kept in the ring's folder beside its lock (`ID.boot`, 8 bytes, big-endian), so that
/// a new process goes on where the former one ended, also after kill -9. A packet shows two bits of its source's boot
/// number: one that follows the former tells the two processes apart before any hello was heard. (ours, protocol.md
/// section 4.8)
class BootRecord {
 public:
  /// Opens or makes the file. Where it cannot be had or holds no number the former one is unknown, and a warning says
  /// so.
  BootRecord(const std::string& directory, std::uint8_t id);
  ~BootRecord();
  BootRecord(const BootRecord&) = delete;
  BootRecord& operator=(const BootRecord&) = delete;

  /// The first boot number of a new process: nanoseconds since 1970, or the next after the former one where that is
  /// higher; its two low bits are the next after the former one's.
  std::uint64_t first(std::uint64_t now_ns) const;
  /// The node now has that one: written where it is another than the last.
  void note(std::uint64_t boot) {
    if (boot != last_) write(boot);
  }

 private:
  void write(std::uint64_t boot);

  int fd_ = -1;
  std::uint64_t last_ = 0;  ///< 0: unknown
};

}  // namespace limb_ring::runtime
