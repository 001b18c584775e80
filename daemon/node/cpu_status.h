#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <string>

#include "wire/control_message.h"

namespace limb_ring::runtime {

/// Where a node's CPU comes from.
enum class CpuKind { none, child, attached };

inline const char* to_string(CpuKind kind) {
  switch (kind) {
    case CpuKind::none:
      return "none";
    case CpuKind::child:
      return "child";
    case CpuKind::attached:
      return "attached";
  }
  return "?";
}

/// What a node's daemon knows of its CPU, as status shows it.
struct CpuStatus {
  CpuKind kind = CpuKind::none;
  /// none: the node has no CPU, but a built-in sink. absent: never attached, gone, or ended with exit 0. booting: its
  /// process runs, but has not attached to the host port yet. running: attached. silent: attached, but without a word
  /// for three of its alive periods. failed: ended badly, did not attach in time, or cannot be executed; see last_exit.
  wire::CpuState state = wire::CpuState::none;
  pid_t pid = -1;           ///< of the process attached, else of the child; -1: neither
  bool ending = false;      ///< that one is a child that was killed and has not gone yet
  bool unsettled = false;   ///< on a virtual ring: a child has let go of the host port, and nobody knows why yet
  std::uint32_t boots = 0;  ///< times a CPU attached to the host port: higher means it really runs
  std::chrono::milliseconds silent{0};        ///< since its last word; 0 where none is attached
  std::chrono::milliseconds alive_period{0};  ///< promised by it or for it (cpu: {alive_period}); 0: no promise
  bool restarted_by_owner = false;            ///< attached: somebody restarts it when it is killed
  std::uint64_t resets = 0;
  std::string last_reset_reason;
  std::uint64_t exits = 0;                    ///< ends of children by themselves
  std::uint64_t failed_boots = 0;             ///< children that did not attach in time, or not at all
  std::chrono::milliseconds restart_wait{0};  ///< last time that was waited before a new start
  std::string last_exit;                      ///< "exit 3", "signal 9 (Killed)", "cannot execute ..."
};

}  // namespace limb_ring::runtime
