#include "runtime/cpu/cpu_status.h"

namespace limb_ring::runtime {

const char* to_string(CpuKind kind) {
  switch (kind) {
    case CpuKind::none: return "none";
    case CpuKind::child: return "child";
    case CpuKind::attached: return "attached";
  }
  return "?";
}

}  // namespace limb_ring::runtime
