#include "core/events.h"
#include "core/outcome.h"

namespace limb_ring::core {

const char* to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::delivered: return "delivered";
    case Outcome::refused: return "refused";
    case Outcome::no_such_node: return "no such node";
    case Outcome::lost: return "lost";
    case Outcome::unconfirmed: return "unconfirmed";
    case Outcome::rejected: return "rejected";
    case Outcome::cancelled: return "cancelled";
  }
  return "";
}

const char* to_string(NodeState state) {
  switch (state) {
    case NodeState::starting: return "starting";
    case NodeState::joining: return "joining";
    case NodeState::up: return "up";
    case NodeState::open_chain: return "open_chain";
    case NodeState::folded: return "folded";
    case NodeState::alone: return "alone";
    case NodeState::doubled_id: return "doubled_id";
  }
  return "unknown";
}

}  // namespace limb_ring::core
