#include "app/ringctl/connect_node.h"

#include "app/ringctl/node_name.h"

namespace limb_ring::ringctl {

HostPortError gone(const HostPort& port, const std::string& reason) {
  return HostPortError("node " + label({port.id(), port.name()}) + " of ring " + port.ring() + ": " + reason);
}

}  // namespace limb_ring::ringctl
