#include "tools/ringctl/connect_node.h"

#include "tools/ringctl/node_name.h"

namespace limb_ring::ringctl {

HostPort connect_within(std::chrono::milliseconds time, const std::string& ring, const std::string& node, Stay stay) {
  const auto deadline = std::chrono::steady_clock::now() + time;
  return connect_node(ring, node, stay, [time, deadline] {
    if (std::chrono::steady_clock::now() >= deadline) throw HostPortTimeout(no_answer_within(time));
  });
}

std::string no_answer_within(std::chrono::milliseconds time) {
  return "its daemon did not answer within " + std::to_string(time.count()) + " ms";
}

HostPortError gone(const HostPort& port, const std::string& reason) {
  return HostPortError("node " + label({port.id(), port.name()}) + " of ring " + port.ring() + ": " + reason);
}

}  // namespace limb_ring::ringctl
