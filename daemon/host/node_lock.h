#pragma once

#include <cstdint>
#include <string>

namespace limb_ring::host {

/// Holds a node for one daemon: a lock on DIRECTORY/ID.lock. Its text says who the holder is, and how to
/// start it again once it is dead: pid, program, working folder, then the arguments, one a line. The
/// kernel gives it up when the process ends, however it ends; children do not inherit it.
class NodeLock {
 public:
  /// @throw std::runtime_error "node 3 (left_knee) of ring r is held by pid 4711 (ringd)", or
  ///        naming the file and what is wrong with it
  NodeLock(const std::string& directory, const std::string& ring, std::uint8_t id,
           const std::string& name);
  ~NodeLock();
  NodeLock(const NodeLock&) = delete;
  NodeLock& operator=(const NodeLock&) = delete;

 private:
  int fd_ = -1;
};

}  // namespace limb_ring::host
