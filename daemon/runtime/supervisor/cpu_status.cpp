#include "runtime/supervisor/cpu_status.h"

namespace limb_ring::runtime {

const char* to_string(CpuKind kind) {
  switch (kind) {
    case CpuKind::none: return "none";
    case CpuKind::child: return "child";
    case CpuKind::attached: return "attached";
  }
  return "?";
}

const char* to_string(CpuState state) {
  switch (state) {
    case CpuState::none: return "none";
    case CpuState::absent: return "absent";
    case CpuState::booting: return "booting";
    case CpuState::running: return "running";
    case CpuState::silent: return "silent";
    case CpuState::failed: return "failed";
  }
  return "?";
}

}  // namespace limb_ring::runtime
