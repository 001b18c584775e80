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

const char* to_string(Reject reject) {
  switch (reject) {
    case Reject::none: return "";
    case Reject::bad_size: return "a packet carries 1 to 512 bytes";
    case Reject::bad_destination: return "no node of that id is configured";
    case Reject::bad_priority: return "priorities are 0 (highest) to 3";
    case Reject::bad_channel: return "channels are 0 to 63, and 1 is the network controllers' own";
    case Reject::bad_factor: return "interrupt factors are 0 to 7";
    case Reject::input_unwired: return "this interrupt input is wired to nothing";
    case Reject::queue_full: return "the send queue is full";
    case Reject::not_in_ring: return "the node is not in a ring";
    case Reject::no_way_out: return "the packet could not go onto the line in time";
  }
  return "unknown";
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
