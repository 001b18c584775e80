#include "app/ringctl/connect_node.h"

#include "app/ringctl/node_name.h"

namespace limb_ring::ringctl {

HostPort connect_node(const std::string& ring, const std::string& node, Stay stay) {
  ConnectOptions options;
  options.ring = ring;
  options.node = node;
  options.asks_only = stay == Stay::asks_only;
  options.timeout = std::chrono::milliseconds(0);
  return HostPort::connect(options);
}

HostPortError gone(const HostPort& port, const std::string& reason) {
  return HostPortError("node " + label({port.id(), port.name()}) + " of ring " + port.ring() + ": " + reason);
}

}  // namespace limb_ring::ringctl
