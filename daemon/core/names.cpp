#include "core/events.h"

namespace limb_ring::core {

const char* to_string(NodeState state) {
  switch (state) {
    case NodeState::starting:
      return "starting";
    case NodeState::joining:
      return "joining";
    case NodeState::up:
      return "up";
    case NodeState::open_chain:
      return "open_chain";
    case NodeState::folded:
      return "folded";
    case NodeState::alone:
      return "alone";
    case NodeState::duplicate_id:
      return "duplicate_id";
  }
  return "unknown";
}

}  // namespace limb_ring::core
