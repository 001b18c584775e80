#include "client/event_kinds.h"

namespace limb_ring::client {

const std::vector<std::string>& event_kinds() {
  static const std::vector<std::string> kinds{"state", "ring", "link", "noise", "pin", "cpu", "watchdog", "sent"};
  return kinds;
}

}  // namespace limb_ring::client
