#include "ring/connect_node.h"

#include <utility>

namespace limb_ring::live {

HostPort connect_node(const std::string& ring, const std::string& node, Stay stay, std::function<void()> meanwhile) {
  ConnectOptions options;
  options.ring = ring;
  options.node = node;
  options.asks_only = stay == Stay::asks_only;
  options.timeout = std::chrono::milliseconds(0);
  options.meanwhile = std::move(meanwhile);
  return HostPort::connect(options);
}

HostPort connect_ring(const std::string& ring) { return connect_node(ring, std::to_string(kBroadcast)); }

nlohmann::json ask_for_people(HostPort& port, const nlohmann::json& request, std::chrono::milliseconds timeout) {
  return nlohmann::json::parse(port.reply(port.request(request.dump()), timeout));
}

}  // namespace limb_ring::live
